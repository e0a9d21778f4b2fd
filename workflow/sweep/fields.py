"""Fields of a scene by dotted path: ``coupling.stiffness``, ``kick.velocity``, ``kick[2].bead``,
``kinds.light.mass``.

Plug-ins take this module for fields that users name: `parse` reads a path, or says which field may have been meant,
`look_up` and `put_all` read and set values in plain data of a scene, `unit`, `label` and `bounds` describe a field.

Examples:
    >>> scene = granchain.load("two-chains").plain()
    >>> path = fields.parse("coupling.stiffness", scene)
    >>> fields.look_up(scene, path), fields.label(path, scene).plain
    (0.1, 'coupling stiffness k (reduced)')
    >>> fields.put_all(scene, {"coupling.stiffness": 0.2})["coupling"]
    {'model': 'linear', 'stiffness': 0.2}
    >>> fields.parse("coupling.stifness", scene)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: a scene has no field 'coupling.stifness' (did you mean `coupling.stiffness`?)
"""

import difflib
import functools
import itertools
import math
import re
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, get_args, get_origin

from annotated_types import Ge, Gt, Le
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from lammps_inputs import InputError, Scene, complaints
from lammps_inputs.ingredients.base import ScenePart
from lammps_inputs.ingredients.by_formula import ByFormula
from lammps_inputs.ingredients.registry import INGREDIENTS, SEVERAL
from lammps_inputs.units import Label, Unit, in_si

_STEP = re.compile(r"([A-Za-z_][A-Za-z0-9_]*|[1-9][0-9]*)(?:\[([1-9][0-9]{0,5})\])?")

_NAMED = ("kinds", "gap.contacts")
"""Keys that hold parts by names of the user's, or values by numbers of contacts."""

Path = tuple[tuple[str, int | None], ...]
"""Key by key, each with the number of the list's entry (from 1) where one was given."""


def parse(text: str, scene: Mapping[str, Any] = MappingProxyType({})) -> Path:
    """The keys of a dotted path, which a scene can have.

    Args:
        text: as the user wrote it.
        scene: plain data of the scene that it is meant for, whose fields are suggested first.

    Returns:
        The keys.

    Raises:
        InputError: no scene has such a field; names what it may have been meant for.
    """
    names = [*all_fields(Scene), *_parameters(scene)]
    matches = [_STEP.fullmatch(part) for part in text.split(".")] if len(text) <= 200 else []
    keys = [match[1] for match in matches if match]
    keys = [key for place, key in enumerate(keys) if ".".join(keys[:place]) not in _NAMED]
    if not matches or not all(matches) or ".".join(keys) not in names:
        meant = [f"`{name}`" for name in _meant(text[:200], names, scene)]
        hint = f" (did you mean {' or '.join(meant)}?)" if meant else ""
        hint = hint or "; `granchain show two-chains` prints one with its fields"
        raise InputError(f"a scene has no field {text[:60]!r}{hint}")
    path = tuple((match[1], None if match[2] is None else int(match[2])) for match in matches if match)
    for key, number in path:
        if number is not None and key not in SEVERAL:
            raise InputError(f"`{key}` is not a list of parts, so it takes no [{number}]")
    return path


def _parameters(scene: Mapping[str, Any]) -> list[str]:
    """Dotted paths of the parameters of forces that are formulas."""
    return [
        f"{key}.{name}"
        for key, part in scene.items()
        if key in FORMULAS and isinstance(part, dict) and "force" in part
        for name in FORMULAS[key].parameters_of(part["force"]) or ()
    ]


FORMULAS = {
    key: kind for key, ingredient in INGREDIENTS.items() for kind in ingredient.kinds() if issubclass(kind, ByFormula)
}
"""Ingredients whose force may be a formula, with parameters beside it."""


_IN_THE_LITERATURE = {"kappa": "coupling.stiffness", "epsilon": "coupling.stiffness", "amplitude": "kick.velocity"}
"""Other names of fields -> the fields that are meant."""

_MOST_MEANT = 3
"""Fields that are suggested for one that there is not."""


def _meant(text: str, paths: list[str], scene: Mapping[str, Any]) -> list[str]:
    """Fields of nearly this path or with this last key; those that the scene has a value for, if it has any."""
    text = _IN_THE_LITERATURE.get(text.lower(), text)
    ends = list(dict.fromkeys(name.rpartition(".")[2] for name in paths))
    end = text.lower() if text.lower() in ends else None
    close = [] if end else difflib.get_close_matches(text, paths, n=1)
    end = end or next(iter([] if close else difflib.get_close_matches(text, ends, n=1)), None)
    candidates = close or [name for name in paths if name.rpartition(".")[2] == end]
    named = list(itertools.chain(*(_with_names(name, scene) for name in candidates)))
    held = [name for name in named if look_up(dict(scene), tuple((key, None) for key in name.split("."))) is not None]
    return (held or named)[:_MOST_MEANT]


def _with_names(field: str, scene: Mapping[str, Any]) -> list[str]:
    """A field of parts that have names, once with each name in the scene."""
    key, dot, rest = field.partition(".")
    if key not in _NAMED or not dot:
        return [field]
    names = scene.get(key)
    return [f"{key}.{name}.{rest}" for name in (names if isinstance(names, dict) and names else ["NAME"])]


@functools.cache
def all_fields(model: type[BaseModel], above: str = "") -> tuple[str, ...]:
    """Dotted paths of all fields of a model and its parts, in their order."""
    paths: list[str] = []
    for name, field in model.model_fields.items():
        paths.append(f"{above}{name}")
        for part in complaints.models_in(field.annotation):
            paths += all_fields(part, f"{above}{name}.")
    return tuple(dict.fromkeys(paths))


def put(scene: dict[str, Any], path: Path, value: Any) -> dict[str, Any]:
    """A copy of a scene's plain data with a field set; parts on the way are made where they are missing.

    Args:
        scene: plain data of the scene, which stays as it is.
        path: the field.
        value: its value.

    Returns:
        The copy.

    Raises:
        InputError: the path names one of several kicks or replacements without its number, or one that there is not.
    """
    (key, number), rest = path[0], path[1:]
    old = scene.get(key)
    if not rest and number is None:
        return {**scene, key: value}
    if key not in SEVERAL or (key != "kick" and old is None):
        return {**scene, key: put(_mapping(old, key), rest, value)}
    kicks = list(old) if isinstance(old, list | tuple) else [old]
    if number is None and len(kicks) > 1:
        raise InputError(f"the scene has {len(kicks)} {_plural(key, len(kicks))}; say which, as in `{key}[1]`")
    place = (number or 1) - 1
    if place >= len(kicks):
        raise InputError(f"the scene has {len(kicks)} {_plural(key, len(kicks))}, so no `{key}[{number}]`")
    kicks[place] = put(_mapping(kicks[place], key), rest, value) if rest else value
    return {**scene, key: kicks}


def put_all(scene: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of a scene's plain data with fields set to values.

    Args:
        scene: plain data of the scene, which stays as it is.
        values: dotted path of a field -> its value.

    Returns:
        The copy, which need not be a valid scene.

    Raises:
        InputError: no scene has such a field, or as `put`.
    """
    for field, value in values.items():
        scene = put(scene, parse(field, scene), value)
    return scene


def _plural(key: str, count: int) -> str:
    return key if count == 1 else f"{key}es" if key.endswith("h") else f"{key}s"


def _mapping(value: Any, key: str) -> dict[str, Any]:
    if value is None or isinstance(value, str):  # a word, such as `rigid`, for a part that may also be said in numbers
        return {}
    if not isinstance(value, dict):
        raise InputError(f"the scene's {key} should hold `key: value` pairs")
    return value


def look_up(scene: dict[str, Any], path: Path) -> Any:
    """Value of a field in a scene.

    Args:
        scene: plain data of the scene.
        path: the field.

    Returns:
        The value; None where the scene does not name it.
    """
    value: Any = scene
    for key, number in path:
        if not isinstance(value, dict):
            return None
        value = value.get(key)
        if isinstance(value, list | tuple):
            if number is None and len(value) != 1:
                return value
            value = value[(number or 1) - 1] if (number or 1) <= len(value) else None
    return value


def held(scene: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float]]:
    """All fields that hold one number in a scene.

    Args:
        scene: plain data of the scene.
        above: dotted path of the part that the data are of, with a dot behind it.

    Yields:
        Dotted path and value of each.
    """
    for key, value in scene.items():
        if isinstance(value, dict):
            yield from held(value, f"{above}{key}.")
        elif isinstance(value, list | tuple) and key in SEVERAL:
            for number, part in enumerate(value, 1):
                yield from held(part, f"{above}{key}[{number}].") if isinstance(part, dict) else ()
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield above + key, value


def no_number(value: Any) -> str:
    """Why a field's value is no number other than 0, in words after its name; empty where it is."""
    if isinstance(value, int | float) and not isinstance(value, bool) and value != 0:
        return ""
    return "is not there" if value is None else f"is {str(value)[:60]!r}"


def is_whole(path: Path) -> bool:
    """Whether a field takes whole numbers only."""
    kinds = _parts(_field(path))
    return int in kinds and float not in kinds


def bounds(path: Path) -> tuple[float, float]:
    """Lower and upper bound of a field of numbers, by its type; infinite where it has none."""
    lower, upper = -math.inf, math.inf
    for part in _parts(_field(path)):
        if isinstance(part, Ge | Gt):
            lower = max(lower, float(part.ge if isinstance(part, Ge) else part.gt))  # type: ignore[arg-type]
        elif isinstance(part, Le):
            upper = min(upper, float(part.le))  # type: ignore[arg-type]
    return lower, upper


def unit(path: Path, scene: dict[str, Any]) -> str:
    """Symbol of a field's unit in a scene, such as ``m/s`` or ``reduced``.

    Args:
        path: the field.
        scene: plain data of the scene.

    Returns:
        The symbol; empty for what has no unit.
    """
    declared = next((part for part in _parts(_field(path)) if isinstance(part, Unit)), None)
    beside = look_up(scene, path[:-1]) if len(path) > 1 else {}
    keys = {**scene, **(beside if isinstance(beside, dict) else {})}
    return "" if declared is None else declared.symbol(keys, si=in_si(scene))


def label(path: Path, scene: dict[str, Any]) -> Label:
    """Words, symbol and unit of a field: those that its type declares, else the words of its path.

    Of a key of a part that is labelled itself, such as the ends of a ramp, both are named; so are the number of an
    entry and the name of a kind.

    Args:
        path: the field.
        scene: plain data of the scene.

    Returns:
        The label.
    """
    keys = [key.replace("_", " ") for key, _ in path]
    names = [f"{key} {number}" for key, number in path if number is not None]
    names += [f"contact {key}" for key in keys if key.isdigit()]
    keys = [key for key in keys if not key.isdigit()]
    if keys[0] in _NAMED and len(keys) > 2:
        names, keys = [f"kind {path[1][0]}"], keys[2:]
    declared = [_declared_label(path[:count]) for count in range(1, len(path) + 1)]
    words = list(dict.fromkeys(label.words for label in declared if label is not None))
    if declared[-1] is None:
        words.append(keys[-1] if words else " ".join(keys))
    symbol = "" if declared[-1] is None or names else declared[-1].symbol
    return Label(", ".join([*words, *names]), symbol, unit(path, scene))


def _declared_label(path: Path) -> Label | None:
    return next((part for part in _parts(_field(path)) if isinstance(part, Label)), None)


def _field(path: Path) -> FieldInfo | None:
    """Field at the end of a path; of a part that may be written as a number alone, the field of that number."""
    models: list[type[BaseModel]] = [Scene]
    last = None
    for key, _ in path:
        named = [
            field for model in models for name, field in model.model_fields.items() if key == (field.alias or name)
        ]
        if named:  # else a name of the user's
            last = named[0]
            models = [model for field in named for model in complaints.models_in(field.annotation)]
    alone = next((model for model in models if issubclass(model, ScenePart) and model.alone is not None), None)
    return last if alone is None else alone.model_fields[str(alone.alone)]


def _parts(declared: Any) -> list[Any]:
    """All that a type is made of, without what stands in the parts of a scene."""
    if isinstance(declared, FieldInfo):
        return [*declared.metadata, *_parts(declared.annotation)]
    inside = get_args(declared)
    if get_origin(declared) is Annotated:
        inside = (*inside[1:], inside[0])  # what annotates a type counts before what is in it
    return [declared, *(part for each in inside for part in _parts(each))]
