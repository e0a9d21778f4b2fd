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
    sample = _sample(values)
    fitting = _fitting(sample)
    if fitting:
        count, word = min(fitting)
        return f"{count} {word}"
    return SINGLE if _is_single(sample) else None


def rounding_error(values: Floats) -> float:
    """Largest error of numbers [...] by the digits to which they were rounded; 0 where they were not.

    Numbers that may have been rounded to digits or to decimals, such as those of 6 digits from 1 to 100, are taken for
    the coarser.
    """
    sample = _sample(values)
    errors = [_largest_error(sample, *form) for form in _fitting(sample)]
    if not errors and _is_single(sample):
        errors = [0.5 * float(np.spacing(np.float32(np.max(np.abs(sample)))))]
    return max(errors, default=0.0)


def _largest_error(sample: Floats, count: int, word: str) -> float:
    """Half of the rounding step of the largest of some numbers, of so many digits or decimals."""
    largest = float(np.max(np.abs(sample)))
    unit = 1.0 if word == "decimals" else 10.0 ** (np.floor(np.log10(largest)) + 1.0)
    return float(0.5 * unit * 10.0**-count)


def _sample(values: Floats) -> Floats:
    """Some different numbers that are not whole, [number]."""
    telling = values[np.isfinite(values) & (values != np.round(values)) & (np.abs(values) > 1e-200)].ravel()
    return np.unique(telling[:: max(1, len(telling) // 2000)])


def _fitting(sample: Floats) -> list[tuple[int, str]]:
    """Digits and decimals to which different numbers [number] may have been rounded; empty where they are too few."""
    if len(sample) < _FEWEST:
        return []
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
    return fitting


def _is_single(sample: Floats) -> bool:
    """Whether different numbers [number] have single precision; not where they are too few."""
    if len(sample) < _FEWEST:
        return False
    with np.errstate(over="ignore", under="ignore"):
        single = sample.astype(np.float32)
        return _all_near(sample, single.astype(np.float64), np.spacing(np.abs(single)).astype(np.float64))


def _all_near(sample: Floats, rounded: Floats, step: Floats) -> bool:
    """Whether practically all numbers are the rounded ones, which are still many different ones."""
    near = float(np.mean(np.abs(rounded - sample) <= _NEAR * step))
    return near > 0.99 and len(np.unique(rounded)) >= _FEWEST
