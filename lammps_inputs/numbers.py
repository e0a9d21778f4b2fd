"""Small helpers for exact and readable numbers."""

import math
import os


def power_of_two_at_least(value: float) -> float:
    """The smallest power of two that is not below a positive value."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(1.0, exponent - 1 if mantissa == 0.5 else exponent)


def text(value: float) -> str:
    """The shortest text that reads back as exactly this number, without a trailing ``.0``."""
    return repr(float(value)).removesuffix(".0")


def known(value: float) -> float | None:
    """A number for a JSON file, which knows none that is infinite or not a number."""
    return value if math.isfinite(value) else None


def memory() -> int:
    """Bytes of memory that this machine has; as good as endless where it does not tell."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):
        return 1 << 62
