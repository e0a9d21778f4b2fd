"""Numbers of few digits, as people write them, in place of measured ones."""

SAME = 1e-8
"""Relative difference of measured numbers that is rounding."""

SHORT = 7
"""Digits of numbers as people write them; a measured number that is one of these within rounding is taken for it."""


def tidy(value: float) -> float:
    """The number of few digits that a measured one is within rounding, or itself."""
    for digits in range(1, SHORT + 1):
        short = float(f"{value:.{digits}g}")
        if abs(short - value) <= 0.1 * SAME * abs(value):
            return short
    return float(value)
