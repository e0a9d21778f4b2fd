"""Moving means of curves whose instants are too far apart to show how they oscillate."""

import math

import numpy as np

from analysis.figures.panels import AxisUnit
from analysis.trajectory import Floats

RESOLVED = 8.0
"""Instants of an oscillation from which on a curve through them shows it."""

_SWING = 0.05
"""Share of the largest energy that a swing of an oscillation has at least."""

_AVERAGED = 6
"""Oscillations that a moving mean is over."""


def oscillations_to_average(values: Floats, largest: float) -> int:
    """Number of instants that a moving mean is over, so that oscillations of values [instant] vanish.

    0 where instants are near enough together to show them, or there are none of `_SWING` times the largest value.
    """
    change = np.diff(values[np.isfinite(values)])
    turns = np.flatnonzero(np.sign(change[1:]) != np.sign(change[:-1])) + 1
    swings = np.count_nonzero(np.abs(np.diff(values[np.isfinite(values)][turns])) > _SWING * largest)
    period = 2.0 * len(values) / swings if swings else np.inf
    if period >= RESOLVED:
        return 0
    return min(max(_LEAST_AVERAGED, math.ceil(_AVERAGED * period)), len(values) // 3)


_LEAST_AVERAGED = 16


def moving_mean(values: Floats, width: int) -> Floats:
    """Mean of the finite values [instant] over so many instants, weighted by a Hann window; values themselves for 0."""
    if not width:
        return values
    weight = np.hanning(width + 2)[1:-1]
    finite = np.isfinite(values)
    with np.errstate(invalid="ignore", divide="ignore"):
        total, weights = (np.convolve(part, weight, mode="same") for part in (np.nan_to_num(values), finite * 1.0))
        return np.asarray(total / weights)


def half_width(time: Floats, width: int) -> float:
    """Duration of a Hann window of so many instants at half its height, in the units of ``time`` [instant]; or 0."""
    if not width:
        return 0.0
    return 0.5 * width * float(time[-1] - time[0]) / (len(time) - 1)


def averaged(mean_over: float, unit: AxisUnit) -> str:
    """Remark on moving means over a duration, in units of T; empty where there are none."""
    return f"mean over {mean_over * unit.worth:.2g}{unit.behind}" if mean_over else ""
