"""Units in the labels of axes."""

import re
from typing import Any

PREFIXES = {"": 1.0, "m": 1e-3, "\N{MICRO SIGN}": 1e-6, "k": 1e3}


def unit_on(label: str, what: Any, unit: str) -> float:
    """What the numbers on an axis, in an SI unit with some prefix, are to be multiplied with, in the scene's units."""
    (word,) = re.findall(r"\(([^()]*)\)$", label)
    if not what.scale.si:
        assert word == "reduced"
        return 1.0
    assert word.endswith(unit)
    return PREFIXES[word.removesuffix(unit)]
