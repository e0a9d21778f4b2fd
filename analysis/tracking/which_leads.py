"""Which maxima are the pulse that leads: with kicks both ways, or noise, not every first maximum of a bead is.

Knows nothing of arrivals or speeds, which are in `leading_waves`.
"""

import numpy as np

from analysis.mirror import direction_of
from analysis.tracking.peaks import PeakFinder, Peaks
from analysis.tracking.pulses import Pulse, track_pulses
from lammps_inputs import Problem, physics


def opposed(problem: Problem) -> bool:
    """Whether there are kicks both ways, so that a bead's first maximum may be what the other pulse left behind."""
    return any(velocity * direction_of(problem) < 0.0 for _, _, velocity in physics.excitations(problem.system))


def leading_finder(problem: Problem) -> PeakFinder:
    """What finds the maxima that `leading_passages` chooses from."""
    return PeakFinder(first_only=not opposed(problem))


def leading_passages(peaks: Peaks, problem: Problem) -> Peaks:
    """Those of a noiseless run's maxima that may be the leading pulse's: all, or with kicks both ways a few."""
    if not opposed(problem):
        return beyond_kicks(peaks, problem)
    return beyond_kicks(of_pulses(peaks, track_pulses(peaks, problem)), problem)


def beyond_kicks(peaks: Peaks, problem: Problem) -> Peaks:
    """The maxima at beads that the leading pulse comes to; behind those that were hit, walls throw others back."""
    if not physics.walls(problem.system):
        return peaks
    way = peaks.direction
    first = min(
        (way * bead for _, bead, velocity in physics.excitations(problem.system) if velocity * way > 0.0),
        default=-problem.beads,
    )
    return peaks.where(way * peaks.bead >= first)


def of_pulses(peaks: Peaks, pulses: tuple[Pulse, ...]) -> Peaks:
    """The maxima that belong to pulses running their way; others are noise, or left by pulses from the far end."""
    passages = {
        (pulse.chain, number, time)
        for pulse in pulses
        if pulse.direction == peaks.direction
        for number, time in zip(pulse.bead.tolist(), pulse.arrival.tolist(), strict=True)
    }
    rows = zip(peaks.chain.tolist(), peaks.bead.tolist(), peaks.time.tolist(), strict=True)
    return peaks.where(np.fromiter((row in passages for row in rows), dtype=bool, count=len(peaks)))
