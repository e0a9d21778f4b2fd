"""Number of digits to which the numbers of a file were rounded, as they show it themselves."""

import numpy as np

from analysis.trajectory import Floats

SINGLE = "single precision"

MOST_DIGITS = 12
"""Numbers with more digits than that pass for whole ones; float64 has 16."""

_NEAR = 1e-3
"""Largest distance from a rounded number, as a share of the rounding step; one number in 500 is there by chance."""

_FEWEST = 20


def precision(values: Floats) -> str | None:
    """Precision to which numbers [...] were rounded: such as "6 digits" (``%g``), "8 decimals", `SINGLE`; or None.

    Sums with other numbers, such as rest positions, may have followed. Whole numbers are no evidence; None where fewer
    than `_FEWEST` different others are found.
    """
    telling = values[np.isfinite(values) & (values != np.round(values)) & (np.abs(values) > 1e-200)].ravel()
    sample = np.unique(telling[:: max(1, len(telling) // 2000)])
    if len(sample) < _FEWEST:
        return None
    digit = 10.0 ** (np.floor(np.log10(np.abs(sample))) + 1.0)
    fitting = []
    for word, form, unit in (("digits", "e", digit), ("decimals", "f", np.ones(len(sample)))):
        for count in range(1, MOST_DIGITS + 1):
            step = unit * 10.0**-count
            if np.any(2.0 * np.spacing(np.abs(sample)) > _NEAR * step):  # float64 itself is hardly finer
                break
            places = count - 1 if form == "e" else count
            if _all_near(sample, np.array([float(f"{value:.{places}{form}}") for value in sample.tolist()]), step):
                fitting.append((count, word))
                break
    if fitting:
        count, word = min(fitting)
        return f"{count} {word}"
    with np.errstate(over="ignore", under="ignore"):
        single = sample.astype(np.float32)
        if _all_near(sample, single.astype(np.float64), np.spacing(np.abs(single)).astype(np.float64)):
            return SINGLE
    return None


def _all_near(sample: Floats, rounded: Floats, step: Floats) -> bool:
    """Whether practically all numbers are the rounded ones, which are still many different ones."""
    near = float(np.mean(np.abs(rounded - sample) <= _NEAR * step))
    return near > 0.99 and len(np.unique(rounded)) >= _FEWEST
