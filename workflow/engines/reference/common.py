"""Compiled functions that do not depend on the laws of a system, for the programs that `kernel` writes."""

from analysis.trajectory import Floats
from workflow.compiled import called_by_compiled


@called_by_compiled
def displaced(x: Floats, first: int, last: int) -> bool:
    """Whether any displacement x[k] of beads [place], from place ``first`` to before ``last``, is not 0."""
    for k in range(first, last):  # noqa: SIM110  compiled
        if x[k] != 0.0:
            return True
    return False


@called_by_compiled
def maximum(early: float, late: float, rise: float, fall: float) -> tuple[float, float]:
    """The maximum within a step of a cubic polynomial: its time as part of the step, and its value.

    The polynomial has these values, and slopes (per step) above and below 0, at the ends of the step.
    """
    square, cube = 3.0 * (late - early) - 2.0 * rise - fall, 2.0 * (early - late) + rise + fall
    low, high = 0.0, 1.0
    for _ in range(50):
        part = 0.5 * (low + high)
        if rise + part * (2.0 * square + part * 3.0 * cube) > 0.0:
            low = part
        else:
            high = part
    return part, early + part * (rise + part * (square + part * cube))


@called_by_compiled
def over_the_way(early: float, middle: float, late: float, first: float, second: float) -> float:
    """Integral of a velocity over an impulse: ``first`` in one half of a time, ``second`` in the other.

    By the trapezoidal rule for the halves and for the whole, extrapolated to fourth order. Summed over all impulses on
    a bead, each rule has the change of its kinetic energy exactly, however the impulses came about.
    """
    halves = 0.5 * (early + middle) * first + 0.5 * (middle + late) * second
    return (4.0 * halves - 0.5 * (early + late) * (first + second)) / 3.0
