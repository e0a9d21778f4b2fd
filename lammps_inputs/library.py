"""Scenes from files and the paper's scenes by name; a user's mistake becomes one line that names file and key.

Examples:
    >>> library.find("one-chain")
    <scene one-chain: 1 chain of 120 beads>
    >>> data = {"name": "mine", "beads": 20, "kick": {"velocity": 1.0}, "duration": 30.0}
    >>> library.from_plain(data, "mine.yaml")
    <scene mine: 1 chain of 20 beads>
    >>> library.from_plain(data | {"beads": 0}, "mine.yaml")
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: mine.yaml: beads: should be greater than or equal to 2, 0 given
"""

import importlib.resources
import itertools
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from lammps_inputs import strict_yaml
from lammps_inputs.complaints import describe, suggestion
from lammps_inputs.errors import InputError
from lammps_inputs.ingredients.registry import INGREDIENTS, NEEDED, NEEDS
from lammps_inputs.installed_scenes import installed
from lammps_inputs.scene import Scene

EDITORS = "# yaml-language-server: $schema="
"""What a YAML file begins with so that editors complete and check it."""

SCHEMA = "templates/scene.schema.json"


def to_start_from(name: str | None) -> str:
    """The text of a scene to write one's own from: a commented one, or an installed one by name.

    Its first line tells editors the schema of scenes, as installed here.

    Raises:
        InputError: no scene of that name is installed.
    """
    package = Path(str(importlib.resources.files("lammps_inputs")))
    scenes = installed()
    if name is not None and name not in scenes:
        raise InputError(f"--from: {name[:60]!r} is no installed scene{suggestion(name, scenes)}")
    text = (package / "templates" / "scene.yaml" if name is None else scenes[name]).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith(EDITORS)]
    return "\n".join([f"{EDITORS}{(package / SCHEMA).as_uri()}", *lines]) + "\n"


def find(name_or_path: str) -> Scene:
    """A scene by the name of an installed one, or from a user's YAML file.

    Raises:
        InputError: no such scene or file, or the file is not a scene.
    """
    scenes = installed()
    if name_or_path in scenes:
        return load(scenes[name_or_path])
    path = Path(name_or_path)
    try:
        exists = path.exists()
    except (OSError, ValueError):
        exists = False
    if not exists and path.suffix not in (".yaml", ".yml"):
        raise InputError(
            f"{name_or_path!r}: neither a file nor an installed scene{suggestion(name_or_path, scenes)}; "
            "`granchain scenes` lists them"
        )
    return load(path)


def load(path: Path) -> Scene:
    """The scene in a YAML file.

    Raises:
        InputError: naming the file, the key, what was given and what would be right.
    """
    try:
        return from_plain(load_plain(path), str(path))
    except InputError as error:
        raise InputError(f"{error}{_absent(path)}") from None


_MOST_COMMENTS = 20
"""Lines at the head of a scene's file in which a comment may name a module."""


def _absent(path: Path) -> str:
    """What the comments of a scene's file say that it needs and is not there, in words; empty without any."""
    try:
        with path.open(encoding="utf-8") as file:
            lines = [line.strip() for line in itertools.islice(file, _MOST_COMMENTS)]
    except (OSError, ValueError):
        return ""
    needed = [line.removeprefix(NEEDED) for line in lines if line.startswith(NEEDED)]
    absent = [words for words in needed if words not in NEEDS.values()]
    return f"; the scene needs {' and '.join(absent)}" if absent else ""


def load_plain(path: Path) -> dict[str, Any]:
    """Content of a scene's YAML file and of the files that it names.

    Raises:
        InputError: as `load`.
    """
    needed = "`granchain show two-chains` prints a scene to start from"
    return with_files(strict_yaml.load(path, needed), path.parent)


def with_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Plain data of a scene, with what it names of files in a folder.

    Raises:
        InputError: one cannot be read.
    """
    ingredients = {key: ingredient for key, ingredient in INGREDIENTS.items() if key in data}
    return data | {key: ingredient.from_files(data[key], folder) for key, ingredient in ingredients.items()}


def from_plain(data: dict[str, Any], source: str) -> Scene:
    """A scene from nested plain data; ``source`` names it in messages.

    Raises:
        InputError: as `load`.
    """
    try:
        return Scene.model_validate(data)
    except ValidationError as error:
        raise InputError(f"{source}: {mistaken(data, 'scene') or describe(error, Scene, data)}") from None
    except MemoryError as error:
        raise InputError(f"{source}: beads: more than this machine's memory holds ({error}); take fewer") from None


def mistaken(data: dict[str, Any], wanted: str) -> str:
    """Message that plain data are of another kind of file than expected, with its command; empty if they are not.

    Args:
        data: content of the file.
        wanted: ``scene``, ``sweep`` or ``design``.
    """
    if "vary" in data:
        kind = "design" if wanted == "design" or data.keys() & {"minimize", "maximize"} else "sweep"
    elif data.keys() & {"beads", "kick"}:
        kind = "scene"
    else:
        return ""
    command = "run" if kind == "scene" else kind
    return "" if kind == wanted else f"looks like a {kind}, not a {wanted}; `granchain {command} FILE -o DIR` takes it"


def render_scene(scene: Scene) -> str:
    """The text of ``scene.yaml``, every default written out; comments name modules that its ingredients need."""
    plain = scene.resolved().plain()
    needed = dict.fromkeys(NEEDS[key] for key in plain if key in NEEDS)
    return "".join(f"{NEEDED}{words}\n" for words in needed) + strict_yaml.dump(plain)
