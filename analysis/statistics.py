"""Statistics and histogram of one quantity over many runs."""

import math

import numpy as np

from analysis.quantity import declare, result
from analysis.trajectory import Floats, Integers

_NO_VALUE = "the quantity is defined in no case of the group"
_UNIT = "that of the quantity"
_ONE_VALUE = "the quantity is defined in fewer than two cases of the group"


@result
class Statistics:
    """Statistics of a quantity over the cases of a group.

    A quantile is interpolated linearly between the ordered values.
    """

    values: int = declare("number of cases in which the quantity is defined")
    undefined: int = declare(
        "number of all other cases: the quantity is undefined, or the case is not done; no statistic includes them"
    )
    mean: float = declare("arithmetic mean of the values", _UNIT, undefined=_NO_VALUE, default=math.nan)
    standard_error: float = declare(
        "standard error of the mean, standard deviation / sqrt(values); 1.96 of it is half of the 95 % confidence "
        "interval of the mean where there are many values",
        _UNIT,
        undefined=_ONE_VALUE,
        default=math.nan,
    )
    standard_deviation: float = declare(
        "standard deviation of the values, with the divisor values - 1", _UNIT, undefined=_ONE_VALUE, default=math.nan
    )
    q5: float = declare("quantile below which 5 % of the values lie", _UNIT, undefined=_NO_VALUE, default=math.nan)
    q25: float = declare("quantile below which 25 % of the values lie", _UNIT, undefined=_NO_VALUE, default=math.nan)
    q50: float = declare("median of the values", _UNIT, undefined=_NO_VALUE, default=math.nan)
    q75: float = declare("quantile below which 75 % of the values lie", _UNIT, undefined=_NO_VALUE, default=math.nan)
    q95: float = declare("quantile below which 95 % of the values lie", _UNIT, undefined=_NO_VALUE, default=math.nan)


@result
class Histogram:
    """Number of values in bins of equal width between the smallest and the largest value.

    There are 2 n^(1/3) bins, rounded up (Rice's rule), and one where all values are equal.
    """

    low: Floats = declare("lower end of the bin", _UNIT)
    high: Floats = declare("upper end of the bin, which belongs to the next bin except in the last one", _UNIT)
    count: Integers = declare("number of values in the bin")


def statistics(values: Floats) -> Statistics:
    """Statistics of values [case], of which those that are NaN are counted as undefined and else ignored."""
    defined = values[np.isfinite(values)]
    count = len(defined)
    if count == 0:
        return Statistics(0, len(values))
    mean = float(defined[0] + np.mean(defined - defined[0]))  # exact where all values are equal
    deviation = float(np.std(defined - defined[0], ddof=1)) if count > 1 else math.nan
    quantiles = np.quantile(defined, (0.05, 0.25, 0.5, 0.75, 0.95)).tolist()
    return Statistics(count, len(values) - count, mean, deviation / math.sqrt(count), deviation, *quantiles)


def histogram(values: Floats) -> Histogram:
    """Histogram of values [case] without those that are NaN; without bins if there are no others."""
    defined = values[np.isfinite(values)]
    if len(defined) == 0:
        return Histogram(np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))
    bins = math.ceil(2.0 * len(defined) ** (1.0 / 3.0)) if np.ptp(defined) > 0.0 else 1
    edges = np.linspace(np.min(defined), np.max(defined), bins + 1)
    return Histogram(edges[:-1], edges[1:], np.histogram(defined, edges)[0])
