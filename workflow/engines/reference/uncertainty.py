"""Bounds on the errors of a reference run."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Uncertainty:
    """Bounds on the errors of a reference run, dimensionless.

    Attributes:
        steps_per_frame: steps of the finer run from frame to frame.
        velocity: the largest error of any velocity, of beads and resonators, is below this, in units of V, as far as
            `step_halving.SAFETY` goes: so many times the largest difference from the run with half as many steps.
        arrival: the same bound for arrivals of the leading pulse, in units of T, where `analysis.tracking.peaks.sharp`.
        energy, momentum: largest deviations from the kicks'.
    """

    steps_per_frame: int
    velocity: float
    arrival: float
    energy: float
    momentum: float
