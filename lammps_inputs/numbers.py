"""Small helpers for exact and readable numbers.

Examples:
    >>> numbers.text(2.0), numbers.text(0.1)
    ('2', '0.1')
    >>> numbers.time_text(4000.0), numbers.size_text(3.3e9)
    ('67 min', '3.3 GB')
    >>> numbers.known(float("nan")), numbers.known(0.5)
    (None, 0.5)
    >>> numbers.plain_values({"beads": np.arange(3)})
    {'beads': [0, 1, 2]}
"""

import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def power_of_two_at_least(value: float) -> float:
    """The smallest power of two that is not below a positive value."""
    mantissa, exponent = math.frexp(value)
    return math.ldexp(1.0, exponent - 1 if mantissa == 0.5 else exponent)


def text(value: float) -> str:
    """The shortest text that reads back as exactly this number, without a trailing ``.0``."""
    return repr(float(value)).removesuffix(".0")


def random_shares(seed: int | list[int], count: int) -> NDArray[np.float64]:
    """Evenly distributed numbers from 0 to 1, [count]: 53 bits of a generator whose stream NumPy guarantees."""
    stream = np.random.PCG64(np.random.SeedSequence(seed))
    return np.asarray((stream.random_raw(count) >> np.uint64(11)) * 2.0**-53)


def number_or_array(values: Any) -> float | NDArray[np.float64]:
    """The number that all values are, or an array of their shape where they differ."""
    array = np.asarray(values)
    return float(array.flat[0]) if np.ptp(array) == 0.0 else array


DEEPEST = 50
"""Levels of nested data; a scene has some five, and data that hold themselves have no end."""


def plain_values(data: Any, levels: int = DEEPEST) -> Any:
    """Nested data as a YAML file has them: numbers and arrays of NumPy as those of Python, tuples as lists.

    Paths become text.

    Args:
        data: mappings, lists and values; whatever else is there remains.
        levels: levels below which nothing is changed.
    """
    if isinstance(data, np.generic | np.ndarray):
        return data.tolist()
    if isinstance(data, os.PathLike):
        return os.fsdecode(data)
    if levels and isinstance(data, Mapping):
        return {key: plain_values(value, levels - 1) for key, value in data.items()}
    if levels and isinstance(data, list | tuple | range):
        return [plain_values(value, levels - 1) for value in data]
    return data


def known(value: float) -> float | None:
    """A number for a JSON file, which has none that is infinite or not a number."""
    return value if math.isfinite(value) else None


def machine_memory() -> int:
    """Bytes of memory that this machine has; infinite where the system does not report it."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):
        return 1 << 62


_TIMES = (
    (2 * 86400.0, 86400.0, "days"),
    (7200.0, 3600.0, "h"),
    (120.0, 60.0, "min"),
    (1.0, 1.0, "s"),
    (1e-3, 1e-3, "ms"),
    (0.0, 1e-6, "us"),
)
_SIZES = ((1e12, 1e12, "TB"), (1e9, 1e9, "GB"), (1e6, 1e6, "MB"), (1e3, 1e3, "kB"), (0.0, 1.0, "bytes"))
"""The least value that is written in a unit, and the unit."""


def time_text(seconds: float) -> str:
    """A time in the unit that people read it in: ``67 min``."""
    return _in_unit(seconds, _TIMES)


def size_text(count: float) -> str:
    """A number of bytes: ``3.3 GB``."""
    return _in_unit(count, _SIZES)


def _in_unit(value: float, units: tuple[tuple[float, float, str], ...]) -> str:
    size, unit = next((size, unit) for least, size, unit in units if value >= least)
    return f"{value / size:.2g} {unit}" if value / size < 99.5 else f"{value / size:.0f} {unit}"
