"""Parts of a file of a user's that holds a scene, such as a sweep or a design: numbers, keys, and the scene itself.

Plug-ins take this module to read such files: a class from `FilePart` names keys and types, `validated` reads one or
refuses it in a line that names the key, `scene_in` reads the scene, `scene_of_file` is its JSON schema.

Examples:
    >>> class Search(file_parts.FilePart):
    ...     tolerance: float
    >>> file_parts.validated(Search, {"tolerance": 0.01}, "search.yaml: ").tolerance
    0.01
    >>> file_parts.validated(Search, {"tolerence": 0.01}, "search.yaml: ")
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: search.yaml: tolerence: unknown key (did you mean `tolerance`?)
"""

from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from lammps_inputs import InputError, complaints, installed_scenes, library, schema

Number = int | float


def number(value: Any) -> Number:
    """A number that a scene may hold.

    Raises:
        ValueError: it is none.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("should be a number")
    if not -1e30 <= value <= 1e30:
        raise ValueError("should be a finite number up to 1e30")
    return value


class FilePart(BaseModel):
    """A part of a file, whose keys are known."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


Kind = TypeVar("Kind", bound=FilePart)


def validated(kind: type[Kind], data: Any, where: str, wanted: str = "") -> Kind:
    """A part of a file from plain data.

    Args:
        kind: class of the part.
        data: plain data of the part.
        where: file and keys above the part's, for messages.
        wanted: kind of the file, a sweep or a design, where the part is all of it.

    Raises:
        InputError: naming the key, what was given and what would be right.
    """
    try:
        return kind.model_validate(data)
    except ValidationError as error:
        mistaken = library.mistaken(data, wanted) if wanted else ""
        raise InputError(f"{where}{mistaken or complaints.describe(error, kind)}") from None


def scene_of_file() -> dict[str, Any]:
    """JSON schema of a scene within a file of another kind, which need not be whole."""
    return {key: value for key, value in schema.scene().items() if key not in ("$schema", "required")}


def scene_in(entry: Any, path: Path, key: str = "scene") -> dict[str, Any]:
    """Plain data of the scene that a file names or holds, which need not be whole: what is varied may be missing.

    Args:
        entry: what the file has under the key.
        path: the file.
        key: the key, for messages.

    Raises:
        InputError: it is neither a scene's name, nor its file, nor the scene itself.
    """
    if isinstance(entry, dict):
        return library.with_files(entry, path.parent)
    if not isinstance(entry, str):
        raise InputError(f"{path}: {key}: should be a name, a file, or the scene's `key: value` pairs")
    installed = installed_scenes.installed()
    if entry in installed:
        return library.load_plain(installed[entry])
    try:
        place = path.parent / entry
        if place.is_file():  # not a device or a pipe, which may never end
            return library.load_plain(place)
    except (OSError, ValueError):
        pass
    hint = complaints.suggestion(entry[:200], installed)
    raise InputError(f"{path}: {key}: {entry[:60]!r} is neither a file nor an installed scene{hint}")
