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
    return _rounded_to(_sample(values))


def rounding_error(values: Floats) -> float:
    """Largest error of numbers [...] by the digits to which they were rounded; 0 where they were not."""
    sample = _sample(values)
    rounded_to = _rounded_to(sample)
    return 0.0 if rounded_to is None else _largest_error(sample, rounded_to)


def _largest_error(sample: Floats, rounded_to: str) -> float:
    """Half of the rounding step of the largest of some numbers."""
    largest = float(np.max(np.abs(sample)))
    if rounded_to == SINGLE:
        return 0.5 * float(np.spacing(np.float32(largest)))
    count, word = rounded_to.split()
    unit = 1.0 if word == "decimals" else 10.0 ** (np.floor(np.log10(largest)) + 1.0)
    return float(0.5 * unit * 10.0 ** -int(count))


def _sample(values: Floats) -> Floats:
    """Some different numbers that are not whole, [number]."""
    telling = values[np.isfinite(values) & (values != np.round(values)) & (np.abs(values) > 1e-200)].ravel()
    return np.unique(telling[:: max(1, len(telling) // 2000)])


def _rounded_to(sample: Floats) -> str | None:
    """Precision to which different numbers [number] were rounded; None where it is not seen, or they are too few."""
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
    if fitting:  # six digits of numbers from 1 to 100 are five decimals, too: the coarser is what they were rounded to
        return max(
            (f"{count} {word}" for count, word in sorted(fitting)), key=lambda form: _largest_error(sample, form)
        )
    with np.errstate(over="ignore", under="ignore"):
        single = sample.astype(np.float32)
        if _all_near(sample, single.astype(np.float64), np.spacing(np.abs(single)).astype(np.float64)):
            return SINGLE
    return None


def _all_near(sample: Floats, rounded: Floats, step: Floats) -> bool:
    """Whether practically all numbers are the rounded ones, which are still many different ones."""
    near = float(np.mean(np.abs(rounded - sample) <= _NEAR * step))
    return near > 0.99 and len(np.unique(rounded)) >= _FEWEST
