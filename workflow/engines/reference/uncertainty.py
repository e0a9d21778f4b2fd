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

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 5.0}).problem()
        >>> uncertainty = StepHalving(problem).run()
        >>> uncertainty.velocity < 1e-5, uncertainty.arrival < 1e-5  # in units of V and T
        (True, True)
    """

    steps_per_frame: int
    velocity: float
    arrival: float
    energy: float
    momentum: float
