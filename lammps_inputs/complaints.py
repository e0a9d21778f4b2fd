"""Mistakes in plain data of a model, such as a scene, as one line that names keys, what they hold and what is valid.

Examples:
    >>> complaints.suggestion("stifness", ["stiffness", "mass"])
    ' (did you mean `stiffness`?)'
    >>> complaints.models_in(output.Limits | None)
    [<class 'lammps_inputs.output.Limits'>]
"""

import difflib
import re
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from lammps_inputs.ingredients.base import ScenePart
from lammps_inputs.ingredients.registry import OWN_INGREDIENTS, SEVERAL
from lammps_inputs.window import LEAST_WINDOW


def describe(error: ValidationError, model: type[BaseModel], data: Any = None) -> str:
    """Pydantic's complaints as one line: of each key what was found and what would be right, unknown keys first.

    Args:
        error: error that the model raised.
        model: model of the file.
        data: content of the file, by which parts of lists are numbered.
    """
    lists = {key for key, value in data.items() if isinstance(value, list) and len(value) > 1} if data else set()
    details = sorted(error.errors(include_url=False), key=lambda detail: detail["type"] != "extra_forbidden")
    lines = [_line(detail, model, lists) for detail in _one_a_key(details, model)]
    text = lines[0]
    for shown, line in enumerate(lines[1:], 1):
        if len(ascii(text)) + len(ascii(line)) > _LONGEST:  # as printed: what cannot be is escaped
            return f"{text} (and {len(lines) - shown} more)"
        text += f"; {line}"
    return text


_LONGEST = 230
"""Characters of several mistakes in one line."""


def _one_a_key(details: list[ErrorDetails], model: type[BaseModel]) -> list[ErrorDetails]:
    """Complaints without repetition: the innermost of those about the same value, and none that another explains."""
    chosen: list[tuple[list[int | str], ErrorDetails]] = []
    for detail in details:
        path = _path(detail, model)
        same = next((k for k, (other, _) in enumerate(chosen) if path[: len(other)] == other[: len(path)]), None)
        if same is None:
            chosen.append((path, detail))
            continue
        above, earlier = chosen[same]
        within = len(path) > len(above) and isinstance(path[len(above)], str)
        if within and earlier["type"] != "extra_forbidden":
            chosen[same] = path, detail
    meant = [[*path[:-1], _meant(path, model)] for path, detail in chosen if detail["type"] == "extra_forbidden"]
    return [detail for path, detail in chosen if detail["type"] != "missing" or path not in meant]


def _meant(path: list[int | str], model: type[BaseModel]) -> str | None:
    """The key that an unknown one at the end of a path was probably meant for."""
    return next(iter(difflib.get_close_matches(str(path[-1]), _known_beside(model, path), n=1)), None)


def _path(detail: ErrorDetails, model: type[BaseModel]) -> list[int | str]:
    """Keys and places of a complaint, without the names that pydantic gives to what may stand there."""
    path: list[int | str] = []
    at = [model]
    by_name = False  # whether what follows is a name of the user's
    for position, part in enumerate(detail["loc"]):
        named = _keys(at)
        unknown = detail["type"] == "extra_forbidden" and position == len(detail["loc"]) - 1
        free = any(each.model_config.get("extra") == "allow" for each in at)
        if any(part == f"<{each.__name__}>" for each in at):
            continue
        if isinstance(part, int) or by_name or part in named or unknown or free:
            path.append(part)
        if by_name:
            by_name = False
        elif part in named:
            at = _within(at, str(part))
            by_name = "dict[" in str(named[str(part)].annotation)
    return path


def _line(detail: ErrorDetails, model: type[BaseModel], lists: set[str]) -> str:
    kind = detail["type"]
    path = _path(detail, model)
    key = _key(path, lists)
    shown = _short(detail["input"])
    context = detail.get("ctx", {})
    if kind == "extra_forbidden":
        if key in _GONE:
            return f"{key}: {_GONE[key]}"
        keys = _known_beside(model, path)
        module = f"; one of your own needs {OWN_INGREDIENTS}=MODULE" if len(path) == 1 and "kick" in keys else ""
        near = suggestion(str(path[-1]), keys)
        meant = near + module if near else _elsewhere(path, model)
        return f"{key}: unknown key{meant or f'; known here: {_listed(keys, _ROOM - len(module))}{module}'}"
    if kind == "missing":
        return f"{key}: is missing"
    if key == "window":
        return f"window: should be `auto` or a whole number of rows, at least {LEAST_WINDOW}, {shown} given"
    if kind == "value_error":
        return f"{key}: {context['error']} ({shown} given)" if key else str(context["error"])
    if kind == "string_pattern_mismatch":
        allowed = "letters, digits, `.`, `_`, `-`, at most 64" if key == "name" else "one line of printable text"
        return f"{key}: {shown} given; {allowed}"
    if kind == "literal_error" and key == "output.beads":
        return f"{key}: should be `all` or a list of bead numbers, {shown} given"
    value = detail["input"]
    if kind in ("int_type", "int_from_float") and isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return f"{key}: {shown} given; write it as a whole number without a point or exponent, {int(value)}"
    message = _PLAIN.get(kind, detail["msg"].removeprefix("Input "))
    if kind == "literal_error":
        message = message.replace("True", "true") + _or_pairs(path, model)
        message += suggestion(str(value), re.findall(r"'([^']*)'", context["expected"]))
    example = _example(path, model) if message == _PAIRS else ""
    if example:
        return f"{key}: {message}, such as `{example}`, {shown} given"
    return f"{key}: {message}, {shown} given"


def _elsewhere(path: list[int | str], model: type[BaseModel]) -> str:
    """Parts of the scene that have an unknown key, in brackets, if these are few; empty if there are none."""
    word, first = str(path[-1]), _keys([model])
    parts = [name for name, field in first.items() if "dict[" not in str(field.annotation)]
    keys = [f"{name}.{word}" for name in parts if word in _keys(models_in(first[name].annotation))]
    keys = ([word] if word in first and len(path) > 1 else []) + keys
    return f" (did you mean {' or '.join(f'`{key}`' for key in keys)}?)" if 0 < len(keys) <= _FEW else ""


_GONE = {
    "output.snapshots": "is no key any more; leave it out, and output.beads too to have all beads in every frame",
}
"""Keys of earlier releases, and what to do in their place."""

_FEW = 6
"""Parts among which a user can choose."""

_PAIRS = "should hold `key: value` pairs"

_PLAIN = {
    "int_type": "should be a whole number",
    "int_from_float": "should be a whole number",
    "float_type": "should be a number",
    "string_type": "should be text",
    "tuple_type": "should be a list",
    "finite_number": "should be a finite number",
    "model_type": _PAIRS,
    "model_attributes_type": _PAIRS,
}


def _example(path: list[int | str], model: type[BaseModel]) -> str:
    """A valid line for the part at a path; empty where there is none."""
    part = next(iter(_models_at(model, path)))
    example = part.example if issubclass(part, ScenePart) else ""
    words = [word for word in path if isinstance(word, str)]
    return f"{words[-1]}: {example}" if example and words else ""


def _or_pairs(path: list[int | str], model: type[BaseModel]) -> str:
    """The keys of the pairs that may stand in place of a word; empty if none may."""
    field = _keys(_models_at(model, path[:-1])).get(str(path[-1]))
    keys = _keys(models_in(field.annotation)) if field else {}
    return f", or hold pairs, `{{{', '.join(keys)}}}`" if keys else ""


def _key(path: list[int | str], lists: set[str]) -> str:
    """Name of a value in messages; a part that stands alone has no number."""
    key = ""
    for position, part in enumerate(path):
        if isinstance(part, int):
            following = position + 1 < len(path)
            alone = key in SEVERAL - lists and part == 0
            key += "" if alone and following else f"[{part + 1}]"
        else:
            word = part if 0 < len(part) <= 60 else _short(part)
            key += f".{word}" if key else word
    return key


def _listed(keys: list[str], room: int) -> str:
    """Keys on one line, as many as fit into so many characters."""
    text = ", ".join(keys)
    return text if len(text) <= room else f"{text[:room].rpartition(',')[0]}, ..."


_ROOM = 120


def _short(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return {None: "nothing", True: "true", False: "false"}[value]
    try:
        text = repr(value)
    except ValueError:  # an integer too long to print
        text = "a huge number"
    return text if len(text) <= 60 else text[:57] + "..."


def _models_at(model: type[BaseModel], path: list[int | str]) -> list[type[BaseModel]]:
    """The innermost models on a path, in which numbers in a list and names that the user gave are no fields."""
    models = [model]
    for part in path:
        models = _within(models, str(part)) or models
    return models


def _within(models: list[type[BaseModel]], key: str) -> list[type[BaseModel]]:
    """The models that fields of models hold under a key in a file."""
    fields = (_keys([model]).get(key) for model in models)
    return list(dict.fromkeys(inner for field in fields if field for inner in models_in(field.annotation)))


def _known_beside(model: type[BaseModel], path: list[int | str]) -> list[str]:
    """The keys that may stand where the last one of a path does."""
    return list(_keys(_models_at(model, path[:-1])))


def _keys(models: list[type[BaseModel]]) -> dict[str, FieldInfo]:
    """The fields of models by their keys in a file, those of the first model before others of the same key."""
    return {field.alias or name: field for model in reversed(models) for name, field in model.model_fields.items()}


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """The models that a field holds, alone, in a list or besides others; none if it holds none."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return list(dict.fromkeys(model for argument in get_args(annotation) for model in models_in(argument)))


def suggestion(word: str, words: Any) -> str:
    """Word that a misspelt one is closest to, in brackets; empty if none is close."""
    close = difflib.get_close_matches(word, list(words), n=1)
    return f" (did you mean `{close[0]}`?)" if close else ""
