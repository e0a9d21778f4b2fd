"""What scripts and notebooks pass to functions: scenes, runs and directories in any of their forms."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, Scene, library
from workflow.runs.run import CompletedRun
from workflow.runs.run_directory import RunDirectory
from workflow.sweep import fields

AnyScene = Scene | Mapping[str, Any] | Path | str
"""A scene, its plain data, its file, or the name of an installed one."""

AnyRun = CompletedRun | RunDirectory | Path | str
"""A run, or its directory."""


def load(scene: AnyScene, changes: Mapping[str, Any] | None = None) -> Scene:
    """Scene by the name of an installed one, from a YAML file, or from plain data; with other values of some fields.

    Args:
        scene: name, path of a file, a mapping of the keys of a scene, or a `Scene`, which itself never changes.
        changes: fields by dotted name, such as ``{"coupling.stiffness": 0.2}``, and their values.

    Returns:
        The validated scene, in the units of its numbers: SI where it has a ``material``, else reduced units.

    Raises:
        InputError: there is no such scene or field, or the scene is invalid; the message names the key.

    Examples:
        >>> granchain.load("two-chains", {"coupling.stiffness": 0.2}).coupling.stiffness
        0.2
        >>> granchain.load({"name": "mine", "beads": 20, "kick": {"velocity": 1.0}, "duration": 30.0})
        <scene mine: 1 chain of 20 beads>
    """
    if isinstance(scene, Mapping):
        loaded = library.from_plain(library.with_files(dict(scene), Path()), "scene")
    else:
        loaded = scene if isinstance(scene, Scene) else library.find(str(scene))
    return library.from_plain(fields.put_all(loaded.plain(), changes), source_of(scene)) if changes else loaded


def source_of(scene: AnyScene) -> str:
    """Name of a scene in messages: the file or name that was passed, else "scene"."""
    return str(scene) if isinstance(scene, str | Path) else "scene"


def path_of(path: object) -> Path:
    """Path of a directory.

    Args:
        path: text, or a path.

    Returns:
        The path.

    Raises:
        InputError: it is no path.
    """
    if not isinstance(path, str | os.PathLike):
        raise InputError(f"directory: {path!r} given; a path such as 'out'")
    return Path(path)


def directory_of(run: AnyRun) -> RunDirectory:
    """Directory of a run.

    Args:
        run: a run, its directory, or the path of that.

    Returns:
        The run directory.

    Raises:
        InputError: there is no run directory at the path.
    """
    if isinstance(run, CompletedRun):
        return run.directory
    return run if isinstance(run, RunDirectory) else RunDirectory(path_of(run))
