"""The maxima of velocity that are the leading pulse's: with kicks both ways not every first one of a bead is.

Plug-ins take this module for those maxima alone, in place of the table of `analysis.tracking.leading_waves`.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> peaks = leading_passages.leading_meter(problem).read(engine.run(problem).blocks())
    >>> leading_passages.leading_passages(peaks, problem).time[:3].round(3)  # at beads 1 to 3, in units of T
    array([0.   , 1.883, 3.121])
"""

import numpy as np

from analysis.tracking.peaks import PeakMeter, Peaks
from analysis.tracking.pulses import Pulse, track_pulses
from lammps_inputs import Problem, physics


def opposed(problem: Problem) -> bool:
    """Whether a bead's first maximum may be residual motion: there are kicks both ways, or the chains are rings, round
    which the residual motion of the kicked bead comes from behind.
    """
    against = any(velocity * problem.direction < 0.0 for _, _, velocity in physics.excitations(problem.system))
    return bool(problem.system.closing) or against


def leading_meter(problem: Problem) -> PeakMeter:
    """Meter of the maxima that `leading_passages` chooses from."""
    return PeakMeter(first_only=not opposed(problem))


def leading_passages(peaks: Peaks, problem: Problem) -> Peaks:
    """Maxima of a run that may be the leading pulse's: all, or a few with kicks in both directions.

    Args:
        peaks: maxima that `leading_meter` found.
        problem: what was run.

    Returns:
        The maxima at beads from the first kicked one on, in the pulse's direction.
    """
    passages = of_pulses(peaks, track_pulses(peaks, problem)) if opposed(problem) else peaks
    return beyond_kicks(passages, problem)


def beyond_kicks(peaks: Peaks, problem: Problem) -> Peaks:
    """The maxima at beads that the leading pulse comes to, from the first kicked bead on.

    Behind it others pass: those that walls reflect, and what runs back from the kick under a static load.
    """
    direction = peaks.direction
    first = min(
        (direction * bead for _, bead, velocity in physics.excitations(problem.system) if velocity * direction > 0.0),
        default=-problem.beads,
    )
    return peaks.where(direction * peaks.bead >= first)


def of_pulses(peaks: Peaks, pulses: tuple[Pulse, ...]) -> Peaks:
    """The maxima that belong to pulses running their way; pulses from the far end leave others."""
    passages = {
        (pulse.chain, number, time)
        for pulse in pulses
        if pulse.direction == peaks.direction
        for number, time in zip(pulse.bead.tolist(), pulse.arrival.tolist(), strict=True)
    }
    rows = zip(peaks.chain.tolist(), peaks.bead.tolist(), peaks.time.tolist(), strict=True)
    return peaks.where(np.fromiter((row in passages for row in rows), dtype=bool, count=len(peaks)))
