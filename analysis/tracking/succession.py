"""Where along a chain the leading pulse ends and another one leads.

What arrives first at a bead is not always what arrived first at the bead before: a pulse that decays ends where its
maximum merges into the rise of a larger one behind it, and ahead of a pulse another one may form. Chains of other beads
or resonators beside a chain do this.

From a bead to the next of its kind the same pulse leads, unless the first maximum there comes at a time at which that
pulse cannot come, while another maximum fits it: one of the bead before, from which the pulse behind comes, or a later
one of the next bead, at which the pulse goes on. To fit is to be `EARLIEST` to `LATEST` times the usual delay apart and
nearer in amplitude.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from analysis.tracking.peaks import Peaks, in_mirror, sharp
from analysis.tracking.pulses import EARLIEST, LATEST, of_one_kind, speed_of_pulses
from analysis.trajectory import Flags, Floats, Integers, mirrored_bead, mirrored_problem
from lammps_inputs import Problem, physics


@dataclass(frozen=True)
class Change:
    """The end of a leading pulse, after which another one leads.

    Attributes:
        chain: number of the chain.
        last: number of the last bead at which the pulse leads.
        first: number of the recorded bead after it, at which another one leads.
        peak_velocity: of the pulse that ends at its last bead, in units of V.
        behind: peak velocity of the other pulse at that bead, where it follows there; NaN where it forms ahead, or
            where maxima behind the first are not known.
    """

    chain: int
    last: int
    first: int
    peak_velocity: float
    behind: float


def changes(peaks: Peaks, problem: Problem) -> tuple[Change, ...]:
    """Where another pulse leads from one bead to the next, chain by chain, along their way.

    None where only first maxima are known. None in chains with gaps, either: a bead moves on with all that it was given
    until it meets the next one, so whatever comes there first is the same pulse.

    Args:
        peaks: maxima at the beads that leading pulses come to, sorted by chain, bead, time.
        problem: what was run.
    """
    if physics.gap(problem.system) > 0.0:
        return ()
    if peaks.direction < 0:
        turned = changes(in_mirror(peaks, problem), mirrored_problem(problem))
        return tuple(
            replace(change, last=mirrored_bead(problem, change.last), first=mirrored_bead(problem, change.first))
            for change in turned
        )
    alike = peaks.where(of_one_kind(problem)[peaks.bead - 1])
    speed = speed_of_pulses(problem)
    found: list[Change] = []
    for chain in np.unique(alike.chain).tolist():
        found += _of_chain(alike.where(alike.chain == chain), partial(speed, chain))
    return tuple(found)


def numbers(first: Peaks, succession: tuple[Change, ...]) -> Integers:
    """Number of the pulse that leads, [maximum], from 1 in each chain, of the first maxima of beads."""
    number = np.ones(len(first), dtype=np.int64)
    way = first.direction
    for change in succession:
        number += (first.chain == change.chain) & (way * first.bead >= way * change.first)
    return number


def _of_chain(peaks: Peaks, speed_at: Callable[[Integers, Floats], Floats]) -> list[Change]:
    """Changes in one chain, of beads of one kind."""
    first = np.flatnonzero(np.diff(peaks.bead, prepend=0))
    end = np.append(first[1:], len(peaks))

    def delay(one: Integers | int, other: Integers | int) -> Floats:
        """Time from maximum to maximum over that which a pulse of this amplitude takes."""
        amplitude = np.sqrt(peaks.velocity[one] * peaks.velocity[other])
        beads = peaks.bead[other] - peaks.bead[one]
        return np.asarray((peaks.time[other] - peaks.time[one]) * speed_at(peaks.bead[other], amplitude) / beads)

    def unlike(one: Integers | int, other: Integers | int) -> Floats:
        return np.abs(np.log(peaks.velocity[one] / peaks.velocity[other]))

    delays = delay(first[:-1], first[1:])
    usual = np.append(1.0, np.where(_plausible(delays), delays, 1.0))[:-1]
    timed = sharp(peaks)[first]
    doubtful = ~_plausible(delays / usual) & timed[:-1] & timed[1:]
    found = []
    for k in np.flatnonzero(doubtful).tolist():
        here, there = int(first[k]), int(first[k + 1])
        behind, later = np.arange(here + 1, end[k]), np.arange(there + 1, end[k + 1])
        nearer = unlike(here, there)
        behind = behind[_plausible(delay(behind, there) / usual[k]) & (unlike(behind, there) < nearer)]
        later = later[_plausible(delay(here, later) / usual[k]) & (unlike(here, later) < nearer)]
        if len(behind) or len(later):
            other = float(peaks.velocity[behind[-1]]) if len(behind) else np.nan
            beads = int(peaks.bead[here]), int(peaks.bead[there])
            found.append(Change(int(peaks.chain[here]), *beads, float(peaks.velocity[here]), other))
    return found


def _plausible(delay: Floats) -> Flags:
    return np.asarray((delay > EARLIEST) & (delay < LATEST))
