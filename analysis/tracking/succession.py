"""Where along a chain the leading pulse ends and another one leads.

What arrives first at a bead is not always what arrived first at the bead before: a pulse that decays ends where its
maximum merges into the rise of a larger one behind it, and ahead of a pulse another one may form. Chains of other beads
or resonators beside a chain do this.

From a bead to the next of its kind the same pulse leads, unless the first maximum there comes at a time at which that
pulse cannot come, while another maximum fits it: one of the bead before, from which the pulse behind comes, or a later
one of the next bead, at which the pulse goes on. To fit is to be `EARLIEST` to `LATEST` times the usual delay apart and
nearer in amplitude.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from analysis.tracking.peaks import Peaks, sharp
from analysis.tracking.pulses import EARLIEST, LATEST, of_one_kind, speed_of_pulses
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem, physics


@dataclass(frozen=True)
class Change:
    """The end of a leading pulse, after which another one leads.

    Attributes:
        chain: number of the chain.
        last: number of the last bead at which the pulse leads.
        first: number of the recorded bead after it, at which another one leads.
        peak_velocity: of the pulse that ends at its last bead, in units of V.
        behind: peak velocity of the other pulse at that bead, where it follows there; NaN where it forms ahead.
    """

    chain: int
    last: int
    first: int
    peak_velocity: float
    behind: float


def changes(peaks: Peaks, problem: Problem) -> tuple[Change, ...]:
    """Ends of leading pulses after which another one leads, chain by chain, in the order of their direction.

    None where only first maxima are known. None in chains with gaps, either: a bead moves on with all that it was given
    until it meets the next one, so whatever comes there first is the same pulse.

    Args:
        peaks: maxima at the beads that leading pulses come to, sorted by chain, bead, time.
        problem: what was run.
    """
    if physics.gap(problem.system) > 0.0:
        return ()
    alike = peaks.where(of_one_kind(problem)[peaks.bead - 1])
    speed = speed_of_pulses(problem)
    ends: list[Change] = []
    for chain in np.unique(alike.chain).tolist():
        ends += _in_chain(alike.where(alike.chain == chain), partial(speed, chain))
    return tuple(ends)


def numbers(first: Peaks, succession: tuple[Change, ...], problem: Problem) -> Integers:
    """Number of the pulse that leads at each bead, [first maximum], from 1 in each chain.

    Args:
        first: first maxima of beads.
        succession: ends of leading pulses.
        problem: what was run.
    """
    number, direction = np.ones(len(first), dtype=np.int64), first.direction
    beginnings = {(change.chain, change.first) for change in succession} | set(_begun_ahead(first, problem))
    for chain, bead in beginnings:
        number += (first.chain == chain) & (direction * first.bead >= direction * bead)
    return number


def _begun_ahead(first: Peaks, problem: Problem) -> Iterator[tuple[int, int]]:
    """Chain and bead of every excitation that makes a pulse before the one behind it comes there."""
    along = first.direction * first.bead
    for chain, bead, impulse in physics.excitations(problem.system):
        at_bead = np.flatnonzero((first.chain == chain) & (first.bead == bead))
        behind = np.flatnonzero((first.chain == chain) & (along < first.direction * bead))
        if impulse * first.direction > 0.0 and len(at_bead) and len(behind):
            before = behind[np.argmax(along[behind])]
            if first.time[at_bead[0]] <= first.time[before]:
                yield chain, bead


def _in_chain(peaks: Peaks, speed_at: Callable[[Integers, Floats], Floats]) -> list[Change]:
    """Changes in one chain, from maxima at beads of one kind."""
    first = np.flatnonzero(np.diff(peaks.bead, prepend=0))
    end = np.append(first[1:], len(peaks))
    first, end = first[:: peaks.direction], end[:: peaks.direction]

    def delay(before: Integers | int, after: Integers | int) -> Floats:
        """Time from maximum to maximum, [pair], over that which a pulse of this amplitude takes."""
        amplitude = np.sqrt(peaks.velocity[before] * peaks.velocity[after])
        beads = np.abs(peaks.bead[after] - peaks.bead[before])
        return np.asarray((peaks.time[after] - peaks.time[before]) * speed_at(peaks.bead[after], amplitude) / beads)

    def difference(before: Integers | int, after: Integers | int) -> Floats:
        """Size of the logarithm of the ratio of two amplitudes, [pair]."""
        return np.abs(np.log(peaks.velocity[before] / peaks.velocity[after]))

    delays = delay(first[:-1], first[1:])
    usual = np.append(1.0, np.where(_plausible(delays), delays, 1.0))[:-1]
    timed = sharp(peaks)[first]
    doubtful = ~_plausible(delays / usual) & timed[:-1] & timed[1:]
    ends = []
    for k in np.flatnonzero(doubtful).tolist():
        last, next_first = int(first[k]), int(first[k + 1])
        behind, later = np.arange(last + 1, end[k]), np.arange(next_first + 1, end[k + 1])
        least = difference(last, next_first)
        behind = behind[_plausible(delay(behind, next_first) / usual[k]) & (difference(behind, next_first) < least)]
        later = later[_plausible(delay(last, later) / usual[k]) & (difference(last, later) < least)]
        if len(behind) or len(later):
            other = float(peaks.velocity[behind[-1]]) if len(behind) else np.nan
            beads = int(peaks.bead[last]), int(peaks.bead[next_first])
            ends.append(Change(int(peaks.chain[last]), *beads, float(peaks.velocity[last]), other))
    return ends


def _plausible(delay: Floats) -> Flags:
    """Mask of delays, over the usual one, with which a pulse may come from one bead to the next."""
    return np.asarray((delay > EARLIEST) & (delay < LATEST))
