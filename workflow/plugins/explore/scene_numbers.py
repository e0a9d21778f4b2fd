"""Numbers of a scene that a page lets change: where they stand, their labels, and ranges of sliders for them."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from granchain import InputError
from granchain.parts import fields, numbers, registry, strict_yaml

SWITCHED = (*registry.INGREDIENTS, "pattern", "replace", "taper", "disorder", "striker")
"""Keys of a scene that can be left out."""

REACH = 3.0
"""Largest value of a slider over the value about which its range is made."""

LONGEST_LIST = 300
"""Characters of a list of numbers that is shown in a field; longer ones are tables from files."""


@dataclass(frozen=True)
class SceneNumber:
    """Number of a scene, or list of numbers.

    Attributes:
        path: where it stands (`workflow.sweep.fields`).
        label: words, symbol and unit.
        value: number, or list.
    """

    path: fields.Path
    label: str
    value: Any

    @property
    def key(self) -> str:
        """Key of the scene that it is, or is part of."""
        return self.path[0][0]

    @property
    def name(self) -> str:
        """Dotted name, such as ``kick[2].velocity``."""
        return ".".join(key if number is None else f"{key}[{number}]" for key, number in self.path)

    @property
    def slides(self) -> bool:
        """Whether it is one number, and has a slider."""
        return not isinstance(self.value, list)


def numbers_of(scene: dict[str, Any]) -> list[SceneNumber]:
    """Numbers of a scene's plain data in their order, lists of numbers as one."""
    return [SceneNumber(path, fields.label(path, scene).plain, value) for path, value in _leaves(_free(scene), ())]


def _free(scene: dict[str, Any]) -> dict[str, Any]:
    """Plain data of a scene without what describes the deck that it was adopted from."""
    return {key: value for key, value in scene.items() if key != "adopted"}


def _leaves(value: Any, path: fields.Path) -> Iterator[tuple[fields.Path, Any]]:
    if isinstance(value, Mapping):
        for key, part in value.items():
            yield from _leaves(part, (*path, (key, None)))
    elif isinstance(value, list) and path[-1][0] in registry.SEVERAL and isinstance(value[0], Mapping):
        for number, part in enumerate(value, 1):
            yield from _leaves(part, (*path[:-1], (path[-1][0], number)))
    elif (_is_number(value) or _holds_number(value)) and len(written(value)) <= LONGEST_LIST:
        yield path, value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _holds_number(value: Any) -> bool:
    parts = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    return any(_is_number(part) or _holds_number(part) for part in parts)


def written(value: Any) -> str:
    """A number or a list of numbers as YAML on one line."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key}: {written(part)}' for key, part in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    if not isinstance(value, float):
        return str(value)
    short = f"{value:g}"
    return min(short, numbers.text(value), key=len) if float(short) == value else numbers.text(value)


def read(words: str, number: SceneNumber) -> Any:
    """Value that a user has typed for a number, as it would be read in a scene's file.

    Raises:
        InputError: the text is no YAML value.
    """
    if "\n" in words:
        raise InputError(f"{number.name}: one line is read here")
    return strict_yaml.parse(f"value: {words}", number.name)["value"]


@dataclass(frozen=True)
class SliderRange:
    """Ends and step of a slider."""

    start: float
    end: float
    step: float

    def rounded(self, value: float, *, is_whole: bool) -> float:
        """Value of the slider without the rounding of its steps."""
        return round(value) if is_whole else float(f"{value:.12g}")


def slider_range(number: SceneNumber, value: float) -> SliderRange:
    """Range of a slider: from 0 to `REACH` times a value, and within the bounds that the scene's type declares."""
    lower, upper = fields.bounds(number.path)
    reach = REACH * abs(value) or 1.0
    step = 10.0 ** math.floor(math.log10(reach / 100.0))
    if fields.is_whole(number.path):
        step = max(1.0, step)
    end = math.ceil(reach / step * (1.0 - 1e-9)) * step
    start, end = (-end, 0.0) if value < 0.0 else (0.0, end)
    return SliderRange(max(start, lower), min(end, upper), step)
