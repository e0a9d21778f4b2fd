"""Which passages of a pulse are undisturbed: clear of the ends of the chain, and of others.

What the leading pulse does to the end of a chain comes back to a bead no sooner than that pulse took from there to the
end, for no other is faster.
"""

from collections.abc import Iterable

import numpy as np

from analysis.shape.exact_wave import SolitaryWave
from analysis.tracking.leading_waves import Waves
from analysis.tracking.pulses import Pulse
from analysis.trajectory import Flags, Floats, Integers, along_the_way
from lammps_inputs import Problem, physics

CLEAR = 5
"""Beads before the end of a chain from which on a pulse feels it."""

APART = 4.0
"""Beads between two pulses from which on neither has any of the other at its peak: the exact wave's velocity has fallen
to 1e-10 there."""


def returns(waves: Waves, problem: Problem, direction: int) -> Floats:
    """Time at which a reflection of leading waves at the end that they run to may reach a bead, [chain, bead] in T.

    Infinite where none has reached that end. Chains that are tied to each other count as one.

    Args:
        waves: leading waves of all chains.
        problem: what was run.
        direction: 1 if they run towards higher bead numbers, else -1.
    """
    back = np.full((problem.chains, problem.beads), np.inf)
    places = along_the_way(problem, np.arange(1, problem.beads + 1), direction)
    for group in physics.groups(problem.system):
        of_group = waves.where(np.isin(waves.chain - 1, sorted(group)) & np.isfinite(waves.time))
        along = along_the_way(problem, of_group.bead, direction)
        bead, place = np.unique(along, return_inverse=True)
        first = np.full(len(bead), np.inf)
        np.minimum.at(first, place, of_group.time)
        if len(bead) == 0 or (bead[-1] < problem.beads and problem.rows.neighbours):
            continue
        end = first[-1]
        if bead[-1] < problem.beads:
            at_last = of_group.where((along == bead[-1]) & (of_group.time == end))
            end += (problem.beads - bead[-1]) / at_last.speed[0]
        back[sorted(group)] = 2.0 * end - np.interp(places, bead, first)
    return back


def clear_of_ends(pulse: Pulse, problem: Problem, back: Floats) -> Flags:
    """[passage] whether neither end of the chain has disturbed a pulse; ``back``: see `returns`."""
    inside = (pulse.bead > CLEAR) & (pulse.bead <= problem.beads - CLEAR)
    return np.asarray(inside & (pulse.arrival < back[pulse.chain - 1, pulse.bead - 1]))


def clear_of_others(
    chain: int, bead: Integers, time: Floats, pulses: Iterable[Pulse], every: float, apart: float = APART
) -> Flags:
    """[passage] whether all other pulses of a chain, of either direction, were ``apart`` beads away.

    Args:
        chain: number of the chain.
        bead, time: [passage] of the passages; a time that is NaN is near no pulse.
        pulses: all pulses; one that passes the same bead at the same time is the same.
        every: time between frames, in units of T.
        apart: least distance of another pulse, in beads.
    """
    clear = np.ones(len(bead), dtype=bool)
    for other in pulses:
        if other.chain == chain:
            order = np.argsort(other.arrival, kind="stable")
            place = np.interp(time, other.arrival[order], other.bead[order], left=np.nan, right=np.nan)
            order = np.argsort(other.bead, kind="stable")
            nearest = order[np.minimum(np.searchsorted(other.bead[order], bead), len(other) - 1)]
            same = (other.bead[nearest] == bead) & (np.abs(other.arrival[nearest] - time) < 0.5 * every)
            clear &= same | ~(np.abs(place - bead) < apart)
    return clear


def once_each(pulses: tuple[Pulse, ...], exact: SolitaryWave) -> tuple[Pulse, ...]:
    """Pulses without second maxima of one and the same passage, such as heavy and light beads have.

    Two are the same where most of the passages of one are nearer in time to the other's, at the same bead, than the
    exact wave takes to pass at half its height; the one seen at more beads stays.
    """
    distinct: list[Pulse] = []
    for pulse in sorted(pulses, key=len, reverse=True):
        near = exact.width / exact.speed_at(pulse.peak_velocity)
        if not any(_same(pulse, other, near) for other in distinct):
            distinct.append(pulse)
    return tuple(pulse for pulse in pulses if any(pulse is other for other in distinct))


def _same(pulse: Pulse, other: Pulse, near: Floats) -> bool:
    if (pulse.chain, pulse.direction) != (other.chain, other.direction):
        return False
    _, place, other_place = np.intersect1d(pulse.bead, other.bead, return_indices=True)
    apart = np.abs(pulse.arrival[place] - other.arrival[other_place])
    return bool(2 * np.count_nonzero(apart < near[place]) > len(pulse))
