"""What scripts and notebooks pass to functions: scenes, runs and directories in any of their forms.

Plug-ins take this module for functions of their own: `AnyScene`, `AnyRun` and `AnyDefinition` are types of arguments of
a function that is `checked`, `source_of` names a scene in messages, `directory_of` is the directory of a run.

Examples:
    >>> @checked
    ... def mass(scene: inputs.AnyScene) -> float:
    ...     return evaluate.mass_of(granchain.load(scene))
    >>> mass("one-chain")
    120.0
    >>> mass(7)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: scene: 7 given; the name of a scene, its file, its plain data or a Scene
"""

import math
import numbers
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from analysis.files.traces import FREE, Given, TraceFile
from lammps_inputs import Scene, library
from lammps_inputs.numbers import plain_values
from workflow.checked import Between, Valid, checked, path
from workflow.runs.completed_run import CompletedRun
from workflow.runs.run_directory import RunDirectory
from workflow.sweep import fields


def _scene(value: Any) -> Any:
    if isinstance(value, Scene):
        return value
    if isinstance(value, Mapping):
        return plain_values(value)
    if isinstance(value, str | os.PathLike) and os.fspath(value):
        return path(value) if isinstance(value, os.PathLike) else str(value)
    raise ValueError("the name of a scene, its file, its plain data or a Scene")


def _run(value: Any) -> Any:
    if isinstance(value, CompletedRun | RunDirectory):
        return value
    if isinstance(value, str | os.PathLike):
        return path(value)
    raise ValueError("a run, or the path of its directory, such as 'out'")


def _compared(value: Any) -> Any:
    if isinstance(value, CompletedRun | RunDirectory | TraceFile):
        return value
    if isinstance(value, str | os.PathLike):
        return path(value)
    raise ValueError("a run, the path of its directory or of a file, or what `trace_file` returns")


def _traces(value: Any) -> Any:
    if isinstance(value, TraceFile):
        return value
    if isinstance(value, str | os.PathLike):
        return path(value)
    raise ValueError("the path of a file of traces, or what `trace_file` returns")


def _calibration(value: Any) -> Any:
    number = isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)
    if not number and value != FREE:
        raise ValueError("a number, or 'free'")
    return value if value == FREE else float(value)


def _definition(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: part.plain() if isinstance(part, Scene) else plain_values(part) for key, part in value.items()}
    if isinstance(value, str | os.PathLike):
        return path(value)
    raise ValueError("the path of a file, or its content as a mapping")


AnyScene = Annotated[Scene | Mapping[str, Any] | Path | str, Valid(_scene)]
"""A scene, its plain data, its file, or the name of an installed one.

Examples:
    >>> @checked
    ... def beads(scene: AnyScene) -> int:
    ...     return granchain.load(scene).beads
    >>> beads("one-chain")
    120
    >>> beads(3)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: scene: 3 given; the name of a scene, its file, its plain data or a Scene
"""

AnyRun = Annotated[CompletedRun | RunDirectory | Path | str, Valid(_run)]
"""A run, or its directory.

Examples:
    >>> @checked
    ... def scene_of(run: AnyRun) -> str:
    ...     return directory_of(run).scene.name
    >>> scene_files.write(granchain.load("one-chain"), tmp)
    >>> scene_of(tmp)
    'one-chain'
"""

AnyCompared = Annotated[CompletedRun | RunDirectory | TraceFile | Path | str, Valid(_compared)]
"""A run, or its directory, or a file.

Examples:
    >>> @checked
    ... def name_of(against: AnyCompared) -> str:
    ...     return str(against)
    >>> name_of("scope.csv")
    'scope.csv'
    >>> name_of(3)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: against: 3 given; a run, the path of its directory or of a file, or what \
`trace_file` returns
"""

AnyTraces = Annotated[TraceFile | Path | str, Valid(_traces)]
"""A file of measured traces, alone or as `trace_file` describes it.

Examples:
    >>> @checked
    ... def name_of(against: AnyTraces) -> str:
    ...     return str(against)
    >>> name_of("scope.csv")
    'scope.csv'
    >>> name_of(3)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: against: 3 given; the path of a file of traces, or what `trace_file` returns
"""

AnyDefinition = Annotated[Mapping[str, Any] | Path | str, Valid(_definition)]
"""A file that holds a scene and what is varied, or its content; the scene may be a `Scene`.

Examples:
    >>> @checked
    ... def scene_of(definition: AnyDefinition) -> str:
    ...     return definition["scene"]
    >>> scene_of({"scene": "one-chain", "vary": {"kick.velocity": [1.0, 2.0]}})
    'one-chain'
    >>> scene_of(3)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: definition: 3 given; the path of a file, or its content as a mapping
"""

Processes = Annotated[int, Between(1, 1024)]
"""Number of worker processes.

Examples:
    >>> @checked
    ... def twice(jobs: Processes) -> int:
    ...     return 2 * jobs
    >>> twice(4)
    8
    >>> twice(0)
    Traceback (most recent call last):
        ...
    lammps_inputs.errors.InputError: jobs: 0 given; a whole number, 1 to 1024
"""


@checked
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


@checked
def trace_file(
    path: Path | str,
    columns: Mapping[str, str] | None = None,
    *,
    skip: Annotated[int, Between(0)] | None = None,
    gain: Mapping[str, Annotated[Given, Valid(_calibration)]] | None = None,
    baseline: Mapping[str, Annotated[Given, Valid(_calibration)]] | None = None,
) -> TraceFile:
    """Describe a file of measured traces, such as an oscilloscope's, for ``fit`` and ``validate``.

    The force (velocity, displacement) is gain (signal - baseline). Columns of the file are named by their headings, or
    by their numbers from 1, such as ``#4``.

    Args:
        path: the file; nothing is read here.
        columns: name of a trace, or ``time``, with a unit in brackets where the file has none -> column of the file.
        skip: number of lines before the names of the columns; by default they are looked for.
        gain: column -> force in N (velocity in m/s, displacement in m) per unit of the column, or ``"free"`` to
            estimate it, with ``fit`` only.
        baseline: column -> signal at rest, in the unit of the column, or ``"free"``; 0 by default.

    Returns:
        The description, for the argument ``against``.

    Raises:
        InputError: an argument is of another kind.

    Examples:
        >>> columns = {"time": "TIME", "force_wall_right (V)": "CH1"}
        >>> scope = granchain.trace_file("scope.csv", columns, gain={"CH1": 20.5})
        >>> scope.path.name, scope.skip
        ('scope.csv', None)
    """
    return TraceFile(Path(path), columns or {}, skip, gain or {}, baseline or {})


def source_of(scene: AnyScene) -> str:
    """Name of a scene in messages.

    Args:
        scene: what was passed.

    Returns:
        The file or name that was passed, else "scene".

    Examples:
        >>> inputs.source_of("one-chain"), inputs.source_of({"beads": 20})
        ('one-chain', 'scene')
    """
    return str(scene) if isinstance(scene, str | Path) else "scene"


def directory_of(run: AnyRun) -> RunDirectory:
    """Directory of a run.

    Args:
        run: a run, its directory, or the path of that.

    Returns:
        The run directory.

    Raises:
        InputError: there is no run directory at the path.

    Examples:
        >>> scene_files.write(granchain.load("one-chain"), tmp)
        >>> directory_of(tmp).scene
        <scene one-chain: 1 chain of 120 beads>
    """
    if isinstance(run, CompletedRun):
        return run.directory
    return run if isinstance(run, RunDirectory) else RunDirectory(Path(run))
