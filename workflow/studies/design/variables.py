"""Fields of a scene that a search may change, each one or several coordinates of a vector."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from workflow.sweep import fields

DIGITS = 6
"""Significant digits of what is not whole, so that two that are as good as the same are computed once."""


EDGE = 0.003
"""Part of a range from its end that counts as the end: the last stride of the search."""


@dataclass(frozen=True)
class Variable:
    """A field and what may stand there.

    Attributes:
        field: dotted path.
        choices: one of these; empty for numbers.
        low, high: of a number, both possible.
        log: whether a number moves by its logarithm.
        whole: whether a number is whole.
        places: entries of a list, where the field takes one: of choices in any order, of numbers ascending.
    """

    field: str
    choices: tuple[Any, ...] = ()
    low: float = 0.0
    high: float = 0.0
    log: bool = False
    whole: bool = False
    places: int | None = None

    @property
    def coordinates(self) -> int:
        """How many it takes."""
        return self.places or 1

    @property
    def bounds(self) -> tuple[float, float]:
        """Of each coordinate."""
        if self.choices:
            return 0.0, float(len(self.choices) - 1)
        return (math.log(self.low), math.log(self.high)) if self.log else (self.low, self.high)

    @property
    def steps(self) -> bool:
        """Whether its coordinates are whole numbers."""
        return bool(self.choices) or self.whole

    @property
    def values(self) -> int | None:
        """How many there are in all; None of what is not counted."""
        if not self.steps:
            return None
        low, high = self.bounds
        each = int(high - low + 1)
        return int(each**self.coordinates)

    def value(self, coordinates: Sequence[float]) -> Any:
        """What stands in the scene."""
        found = [self._one(coordinate) for coordinate in coordinates]
        if self.places is None:
            return found[0]
        return found if self.choices else sorted(found)

    def _one(self, coordinate: float) -> Any:
        if self.choices:
            return self.choices[round(coordinate)]
        if self.whole:
            return round(coordinate)
        value = math.exp(coordinate) if self.log else float(coordinate)
        return min(max(float(f"{value:.{DIGITS}g}"), self.low), self.high)

    def bound(self, value: Any) -> str:
        """``from`` or ``to`` where a number, or one of a list, is at the end of its range; else empty."""
        if self.choices:
            return ""
        low, high = self.bounds
        edge = 0.0 if self.whole else EDGE * (high - low)
        found = value if isinstance(value, list) else [value]
        at = [math.log(one) if self.log else one for one in found]
        return "from" if min(at) <= low + edge else "to" if max(at) >= high - edge else ""


def values_of(variables: Sequence[Variable], vector: Sequence[float]) -> dict[str, Any]:
    """Field -> value, from a vector of all coordinates."""
    found, start = {}, 0
    for variable in variables:
        found[variable.field] = variable.value(list(vector[start : start + variable.coordinates]))
        start += variable.coordinates
    return found


def scene_with(scene: dict[str, Any], values: dict[str, Any]) -> dict[str, Any]:
    """Plain data of a scene with values in fields.

    Raises:
        InputError: the scene has no such place.
    """
    for field, value in values.items():
        scene = fields.put(scene, fields.parse(field), value)
    return scene
