"""Free fields of a scene: which, from where, and the scene with other values."""

import math
from dataclasses import dataclass
from typing import Any

from lammps_inputs import InputError
from workflow.sweep import fields


@dataclass(frozen=True)
class Free:
    """Fields that are to be found; each is its starting value times the exponential of a parameter, so keeps its sign.

    Attributes:
        names: as the user wrote them.
        start: their values in the scene.
    """

    names: tuple[str, ...]
    start: tuple[float, ...]

    def values(self, logarithms: Any) -> list[float]:
        """Of the fields, from the parameters."""
        return [start * math.exp(value) for start, value in zip(self.start, logarithms, strict=True)]

    def put(self, scene: dict[str, Any], values: list[float]) -> dict[str, Any]:
        """Plain data of the scene with these values."""
        for name, value in zip(self.names, values, strict=True):
            scene = fields.put(scene, fields.parse(name), value)
        return scene


def free(names: list[str], scene: dict[str, Any], source: str) -> Free:
    """Fields by name, with what the scene has there.

    Raises:
        InputError: no field, one twice, or one that holds no number to start from.
    """
    if not names:
        raise InputError("--free: name at least one field, such as coupling.stiffness")
    start = []
    for name in names:
        try:
            path = fields.parse(name, scene)
        except InputError as error:
            raise InputError(f"--free: {error}") from None
        if names.count(name) > 1:
            raise InputError(f"--free: {name} is named twice")
        value = fields.look_up(scene, path)
        if isinstance(value, bool) or not isinstance(value, int | float) or value == 0:
            found = "is not there" if value is None else f"is {str(value)[:60]!r}"
            raise InputError(
                f"{source}: {name}: {found}; a free field needs a number other than 0 in the scene to start from"
            )
        if fields.is_whole(path):
            raise InputError(f"--free: {name} counts something, so it is no number that can change little by little")
        start.append(float(value))
    return Free(tuple(names), tuple(start))
