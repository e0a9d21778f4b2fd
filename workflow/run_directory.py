"""A run directory: what one run was given, what came out, and how it ended.

| file              | written by                                     |
|-------------------|------------------------------------------------|
| scene.yaml        | the scene with every default written out       |
| in.chains, data.chains | the deck (LAMMPS only)                    |
| chains.dump.bin   | frames: id, x, vx of the recorded beads        |
| log.lammps        | LAMMPS's log (LAMMPS only)                     |
| events.csv        | collisions (engine `collisions` only)          |
| run.json          | versions, command, host, times, outcome        |

Every file is written whole under another name and then renamed, except the dump, whose frames are whole one by one.
"""

import io
import json
import math
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis import recording
from analysis.trajectory import Trajectory, joined
from lammps_inputs import InputError, Problem, Scene, deck, load

if TYPE_CHECKING:
    from matplotlib.figure import Figure  # takes a while to import

RECORD = "run.json"
EVENTS = "events.csv"

OWN_FILES = (deck.SCENE, deck.DECK, deck.DATA, deck.DUMP, deck.LOG, EVENTS, RECORD)
ANALYSIS_FILES = (
    "waves.csv",
    "analysis.json",
    *(f"{name}.{suffix}" for name in ("spacetime", "response", "distance", "shape") for suffix in ("png", "pdf")),
    *("validation.json", "validation.png", "validation.pdf"),
)


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def write_figure(directory: Path, name: str, figure: "Figure") -> tuple[Path, ...]:
    """Write a figure as PNG and as PDF; returns the files."""
    paths = tuple(directory / f"{name}.{suffix}" for suffix in ("png", "pdf"))
    for path in paths:
        out = io.BytesIO()
        figure.savefig(out, format=path.suffix[1:])
        write_bytes(path, out.getvalue())
    return paths


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write JSON whole or not at all; numbers round-trip, and what is not finite becomes null, for JSON has no NaN."""
    write_text(path, json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


def prepare(directory: Path, *, overwrite: bool = False) -> None:
    """Make a directory for a new run.

    Args:
        directory: new, or empty, or with ``overwrite`` one that holds an earlier run, whose files are removed.
        overwrite: whether an earlier run may be replaced. Files that are not a run's are never touched.

    Raises:
        InputError: the directory holds something, or cannot be made.
    """
    try:
        if directory.exists() and not directory.is_dir():
            raise InputError(f"{directory}: is a file, not a directory; choose another -o")
        if directory.is_dir() and any(directory.iterdir()):
            if not overwrite:
                raise InputError(f"{directory}: exists and is not empty; choose another -o, or give --overwrite")
            if not (directory / deck.SCENE).is_file():
                raise InputError(f"{directory}: is not a run directory, so it is not overwritten; choose another -o")
            for name in (*OWN_FILES, *ANALYSIS_FILES):
                (directory / name).unlink(missing_ok=True)
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory):
            pass
    except OSError as error:
        raise InputError(f"{directory}: cannot be written to ({error.strerror})") from None


@dataclass(frozen=True)
class RunDirectory:
    """An existing run directory, also one that came back from a cluster without ``run.json``."""

    path: Path

    def __post_init__(self) -> None:
        try:
            found, whole = self.path.is_dir(), (self.path / deck.SCENE).is_file()
        except OSError as error:
            raise InputError(f"{self.path}: cannot be read ({error.strerror})") from None
        if not found:
            raise InputError(f"{self.path}: no such directory")
        if not whole:
            raise InputError(f"{self.path}: not a run directory (it has no {deck.SCENE})")

    @cached_property
    def scene(self) -> Scene:
        """The scene as it was run."""
        return load(self.path / deck.SCENE)

    @cached_property
    def problem(self) -> Problem:
        """The dimensionless problem of the scene."""
        scene = self.scene
        try:
            return scene.problem()
        except ValueError as error:
            raise InputError(f"{self.path / deck.SCENE}: {error}") from None

    @property
    def record(self) -> dict[str, Any]:
        """What ``run.json`` holds; empty if there is none.

        Raises:
            InputError: it is not JSON.
        """
        path = self.path / RECORD
        if not path.is_file():
            return {}
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except (ValueError, OSError) as error:
            raise InputError(f"{path}: cannot be read ({error})") from None
        return data if isinstance(data, dict) else {}

    def update_record(self, **changes: Any) -> None:
        """Add to ``run.json``."""
        write_json(self.path / RECORD, {**self.record, **changes})

    @property
    def dump(self) -> Path:
        """The file of frames.

        Raises:
            InputError: there is none.
        """
        path = self.path / deck.DUMP
        if not path.is_file():
            raise InputError(f"{self.path}: holds no {deck.DUMP}; run the deck first")
        return path

    def blocks(self, stride: int = 1) -> Iterator[Trajectory]:
        """The frames there are, or every stride-th of them, in blocks of bounded size."""
        return recording.blocks([self.dump], self.problem, stride)

    @property
    def trajectory(self) -> Trajectory:
        """The whole trajectory in memory."""
        return joined(self.blocks())
