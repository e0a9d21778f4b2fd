"""Statistics of a quantity over the seeds of an ensemble."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

NORMAL = 1.96
"""Half of the 95 % interval of a normal distribution, in standard deviations."""


@dataclass(frozen=True)
class Statistics:
    """Of the seeds at which the quantity is defined.

    Attributes:
        values: number of these.
        undefined: number of all others, which nothing else here includes.
        mean: None without a value.
        standard_error: of the mean, ``standard_deviation / sqrt(values)``.
        interval_95: half-width of the 95 % confidence interval of the mean, 1.96 standard errors: the normal
            approximation, which is too narrow for few values (by 13 % for ten).
        standard_deviation: of the values, with ``values - 1``; None for fewer than two, as what follows from it.
        q2_5, q16, q50, q84, q97_5: quantiles in %, interpolated linearly between the ordered values, which are the
            ends of the range for quantiles beyond them; None without a value.
        seeds_needed: least number of seeds with which ``interval_95`` is at most the wished share of the mean, if
            as large a share of them has a value; None where the mean is 0.
    """

    values: int
    undefined: int
    mean: float | None
    standard_error: float | None
    interval_95: float | None
    standard_deviation: float | None
    q2_5: float | None
    q16: float | None
    q50: float | None
    q84: float | None
    q97_5: float | None
    seeds_needed: int | None


def statistics(values: Sequence[float | None], precision: float) -> Statistics:
    """Of one value a seed, None where it is undefined.

    Args:
        values: of the quantity.
        precision: wished half-width of the 95 % interval of the mean over the mean.
    """
    found = np.array([value for value in values if value is not None], dtype=np.float64)
    count = len(found)
    mean = error = interval = deviation = needed = None
    quantiles: list[float | None] = [None] * 5
    if count:
        mean = float(found[0] + np.mean(found - found[0]))  # exact where all are the same
        quantiles = [float(one) for one in np.quantile(found, (0.025, 0.16, 0.5, 0.84, 0.975))]
    if mean is not None and count > 1:
        deviation = float(np.std(found - found[0], ddof=1))
        error = deviation / math.sqrt(count)
        interval = NORMAL * error
        if mean != 0.0:
            one = (NORMAL * deviation / (precision * mean)) ** 2
            needed = max(1, math.ceil(one * len(values) / count))
    q2_5, q16, q50, q84, q97_5 = quantiles
    return Statistics(count, len(values) - count, mean, error, interval, deviation, q2_5, q16, q50, q84, q97_5, needed)
