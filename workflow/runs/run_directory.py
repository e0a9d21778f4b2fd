"""A run directory: what one run was given, what came out, and how it ended.

| file              | written by                                     |
|-------------------|------------------------------------------------|
| scene.yaml        | the scene with every default written out       |
| in.chains, data.chains | the deck (LAMMPS only)                    |
| chains.dump.bin   | frames: id, x, vx of the recorded beads; those of a continued run go on in chains.dump.2.bin, .3 |
| chains.restart, in.continue | where to go on from, and how (LAMMPS only) |
| log.lammps        | LAMMPS's log (LAMMPS only)                     |
| events.csv        | collisions (engine `collisions` only)          |
| run.json          | versions, command, host, times, outcome        |

Every file is written whole under another name and then renamed, except the dump, whose frames are whole one by one.
A directory is locked while something runs in it. Which files are ours, and may be replaced: see `own_files`.
"""

import fcntl
import io
import json
import math
import os
import re
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.files import recording
from analysis.trajectory import Trajectory, joined
from lammps_inputs import InputError, Problem, Scene, load
from lammps_inputs.decks import continuation, deck
from lammps_inputs.slurm import job
from workflow.errors import EndedError, RunError
from workflow.runs.record import RECORD, read_record

if TYPE_CHECKING:
    from matplotlib.figure import Figure  # takes a while to import

EVENTS = "events.csv"
REPORT = "analysis.json"

OWN_FILES = (
    *(deck.SCENE, deck.DECK, deck.DATA, deck.DUMP, deck.LOG, EVENTS, RECORD),
    *(
        continuation.CONTINUE,
        continuation.RESTART,
        continuation.RESTART_SUMS,
        continuation.UNFINISHED,
        deck.PEAKS,
        deck.PEAKS_STATE,
    ),
    *job.OWN_FILES,
    deck.SNAPSHOTS,
)
ANALYSIS_FILES = (
    "waves.csv",
    REPORT,
    *(
        f"{name}.{suffix}"
        for name in ("spacetime", "response", "distance", "shape", "energy")
        for suffix in ("png", "pdf")
    ),
    *("validation.json", "validation.png", "validation.pdf"),
    *("compare.json", "compare.png", "compare.pdf"),
)


TEMPORARY = ".granchain-"
"""In the name of a file that is being written, so that a kill leaves nothing that could be somebody else's."""

_PART = re.compile(r"chains\.(dump|snapshots)(?:\.([1-9][0-9]{0,8}))?\.bin")


def run_files(engine: str) -> tuple[str, ...]:
    """What a run by an engine, or the deck for LAMMPS, may leave in its directory before it is analysed."""
    if engine != "lammps":
        return (deck.SCENE, RECORD, deck.DUMP, EVENTS)
    return tuple(name for name in OWN_FILES if name != EVENTS and name not in job.OWN_FILES)


_LOCK_SECONDS = 3.0
"""How long the processes of a killed run may take to end."""


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    Raises:
        EndedError: it cannot be written; what was there before still is.
    """
    try:
        _write(path, content)
    except OSError as error:
        raise EndedError(f"{path}: cannot be written ({error.strerror}); what was there is left as it was") from None


def _write(path: Path, content: bytes) -> None:
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}{TEMPORARY}")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def figure_files(*names: str) -> tuple[str, ...]:
    """Names of the files of figures."""
    return tuple(f"{name}.{suffix}" for name in names for suffix in ("png", "pdf"))


def write_figure(directory: Path, name: str, figure: "Figure") -> tuple[Path, ...]:
    """Write a figure as PNG and as PDF; returns the files.

    Raises:
        RunError: it holds numbers that cannot be drawn.
    """
    import matplotlib as mpl

    from analysis.figures.style import STYLE

    paths = tuple(directory / file for file in figure_files(name))
    for path in paths:
        out = io.BytesIO()
        try:
            with mpl.rc_context(STYLE):  # fonts and resolution are settings of saving, not of drawing
                figure.savefig(out, format=path.suffix[1:])
        except OverflowError:
            raise RunError(f"{path}: numbers near 1e308 cannot be drawn; are the frames damaged?") from None
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


@contextmanager
def alone(directory: Path) -> Iterator[int]:
    """Keep other runs out of a directory.

    Yields:
        A file descriptor: a process that inherits it keeps others out until it ends, too.

    Raises:
        InputError: something runs there.
    """
    handle = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        end = time.monotonic() + _LOCK_SECONDS
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > end:
                    raise InputError(f"{directory}: a run is under way in it; wait for its end, or end it") from None
                time.sleep(0.05)
            except OSError:  # a file system without locks
                break
        yield handle
    finally:
        os.close(handle)


@contextmanager
def changing(path: Path) -> Iterator[None]:
    """Read a file and write it anew with nobody else doing so in between; a run and its analysis share ``run.json``."""
    while True:
        try:
            handle = os.open(path, os.O_RDONLY)
        except OSError:  # it is not there yet, or is nobody's who writes here
            yield
            return
        try:
            with suppress(OSError):  # a file system without locks
                fcntl.flock(handle, fcntl.LOCK_EX)
            with suppress(OSError):
                if not os.path.samestat(os.fstat(handle), path.stat()):
                    continue  # it was replaced meanwhile
            yield
            return
        finally:
            os.close(handle)


def parts(directory: Path, kind: str = "dump") -> list[Path]:
    """The files of frames there are, in order; with "snapshots" those of all beads beside frames of some."""
    found = {path: match for path in directory.iterdir() if (match := _PART.fullmatch(path.name)) and path.is_file()}
    return sorted((path for path, match in found.items() if match[1] == kind), key=part_number)


def all_parts(directory: Path) -> list[Path]:
    """The files of frames and those of snapshots."""
    return [*parts(directory), *parts(directory, "snapshots")]


def part_number(path: Path) -> int:
    """Number of a file of frames; 0 if it is none."""
    match = _PART.fullmatch(path.name)
    return 0 if match is None else int(match[2] or 1)


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
        return read_record(path) if path.is_file() else {}

    @property
    def failure(self) -> str:
        """Why the run failed, in words; empty where it did not, or where ``run.json`` does not tell."""
        try:
            record = self.record
        except InputError:
            return ""
        return f"the run failed: {record.get('reason')}" if record.get("outcome") == "failed" else ""

    @property
    def engine(self) -> str:
        """What computed the run: LAMMPS where ``run.json`` does not tell."""
        try:
            return str(self.record.get("engine", "lammps"))
        except InputError:
            return "lammps"

    def update_record(self, **changes: Any) -> None:
        """Add to ``run.json``, or with None take away."""
        with changing(self.path / RECORD):
            record = {**self.record, **changes}
            write_json(self.path / RECORD, {key: value for key, value in record.items() if value is not None})

    @property
    def dumps(self) -> list[Path]:
        """The files of frames, in order; more than one if the run was continued.

        Raises:
            InputError: there is none.
        """
        found = parts(self.path)
        if not found or found[0].name != deck.DUMP:
            raise InputError(f"{self.path}: holds no {deck.DUMP}; run the deck first")
        return found

    @property
    def dump(self) -> Path:
        """The first of the files of frames.

        Raises:
            InputError: there is none.
        """
        return self.dumps[0]

    def blocks(self, stride: int = 1) -> Iterator[Trajectory]:
        """The frames there are, or every stride-th of them, in blocks of bounded size."""
        return recording.blocks(self.dumps, self.problem, stride)

    def snapshots(self) -> Iterator[Trajectory]:
        """The snapshots of all beads, in blocks of bounded size; none where the scene asks for none."""
        files = parts(self.path, "snapshots")
        if self.problem.frames_per_snapshot is not None and files:
            yield from recording.blocks(files, self.problem.snapshots())

    @property
    def trajectory(self) -> Trajectory:
        """The whole trajectory in memory."""
        return joined(self.blocks())
