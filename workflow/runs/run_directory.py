"""A run directory: inputs, outputs and state of one run.

| file              | written by                                     |
|-------------------|------------------------------------------------|
| scene.yaml        | the scene with every default written out       |
| in.chains, data.chains | the deck (LAMMPS only)                    |
| in.tables         | long tables of forces, which the deck includes (LAMMPS only) |
| chains.dump.bin   | frames: id, x, vx of the recorded beads; of a resumed run also in chains.dump.2.bin, .3 |
| chains.restart, in.continue | state to resume from, and its input (LAMMPS only) |
| log.lammps        | LAMMPS's log (LAMMPS only)                     |
| run.json          | versions, command, host, times, outcome        |

Every file is written whole, except the dump, whose frames are whole one by one, and a directory is locked while
something runs in it (`files`). Which files are ours, and may be replaced: see `output_directory`.

Here is also what ``run.json`` records of a run: its input's fingerprint, and its results, the number and fingerprint of
its frames, enough to determine whether these are the ones that it wrote.
"""

import hashlib
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from analysis.compare import start
from analysis.files import recording
from analysis.files.binary_dump import CutDumpWarning
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import InputError, Problem, Scene, file_names, load
from workflow.errors import RunError
from workflow.runs.engines import engine_called
from workflow.runs.files import RECORD, parts
from workflow.runs.job import Job, account, update
from workflow.runs.job import load as load_job

KEPT_BYTES = 1 << 24
"""Largest size of the frames of a run that stay in memory for the next reader."""


@dataclass(frozen=True)
class RunDirectory:
    """An existing run directory, also one that came back from a cluster without ``run.json``.

    Attributes:
        path: the directory.

    Examples:
        >>> scene_files.write(granchain.load("one-chain"), tmp)
        >>> directory = RunDirectory(tmp)
        >>> directory.scene, directory.problem.frames
        (<scene one-chain: 1 chain of 120 beads>, 1600)
        >>> directory.engine, directory.failure
        ('lammps', '')
    """

    path: Path

    def __post_init__(self) -> None:
        try:
            exists, has_scene = self.path.is_dir(), (self.path / file_names.SCENE).is_file()
        except OSError as error:
            raise InputError(f"{self.path}: cannot be read ({error.strerror})") from None
        if not exists:
            raise InputError(f"{self.path}: no such directory")
        if not has_scene:
            raise InputError(f"{self.path}: not a run directory (it has no {file_names.SCENE})")

    @classmethod
    def begun_with(cls, path: Path, scene: Scene, problem: Problem) -> "RunDirectory":
        """The directory of a run whose scene, with every default written out, and problem need not be read."""
        directory = cls(path)
        vars(directory).update(scene=scene, problem=problem)
        return directory

    @cached_property
    def scene(self) -> Scene:
        """The scene as it was run."""
        return load(self.path / file_names.SCENE)

    @cached_property
    def problem(self) -> Problem:
        """The dimensionless problem of the scene."""
        scene = self.scene
        try:
            return engine_called(self.engine).problem(scene)
        except ValueError as error:
            raise InputError(f"{self.path / file_names.SCENE}: {error}") from None

    @property
    def job(self) -> Job:
        """What ``run.json`` holds; nothing if there is none.

        Raises:
            InputError: it cannot be read.
        """
        return load_job(self.path / RECORD)

    @property
    def account(self) -> Job:
        """What ``run.json`` holds; nothing where there is none, or it cannot be read."""
        return account(self.path)

    @property
    def failure(self) -> str:
        """Why the run failed, in words; empty where it did not, or where ``run.json`` does not say."""
        return f"the run failed: {self.account.reason}" if self.account.outcome == "failed" else ""

    @property
    def engine(self) -> str:
        """What computed the run: LAMMPS where ``run.json`` does not say."""
        return self.account.engine or "lammps"

    @property
    def fingerprint(self) -> str:
        """Fingerprint of the frames, see `results`; empty where ``run.json`` holds none."""
        results = self.account.results
        return "" if results is None else results.sha256

    def update(self, **changes: Any) -> None:
        """Add to ``run.json``, or with None take away."""
        update(self.path, **changes)

    @property
    def dumps(self) -> list[Path]:
        """The files of frames, in order; more than one if the run was continued.

        Raises:
            InputError: there is none.
        """
        files = parts(self.path)
        if not files or files[0].name != file_names.DUMP:
            raise InputError(f"{self.path}: holds no {file_names.DUMP}; run the deck first")
        return files

    @property
    def dump(self) -> Path:
        """The first of the files of frames.

        Raises:
            InputError: there is none.
        """
        return self.dumps[0]

    def blocks(self, stride: int = 1) -> Iterator[Trajectory]:
        """The frames there are, or every stride-th of them, in blocks of bounded size.

        Args:
            stride: only every so many frames; 1 for all.

        Returns:
            Consecutive frames, [frame, chain, bead] each.

        Raises:
            InputError: there are none, or they cannot be read.
            RunError: they are not frames of the scene, by LAMMPS's log, by their times or by the state of the first.
        """
        problem, dumps = self.problem, self.dumps
        if stride > 1 or 16.0 * problem.frames * problem.chains * problem.rows.count > KEPT_BYTES:
            return self._begun_as_the_scene(recording.blocks(dumps, problem, stride))
        return self._begun_as_the_scene(self._in_memory.frames(dumps, problem))

    def blocks_so_far(self, stride: int = 1) -> Iterator[Trajectory]:
        """Blocks as `blocks` yields them, without a warning where the file ends within a frame."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", CutDumpWarning)
            yield from self.blocks(stride)

    @cached_property
    def _in_memory(self) -> "FramesInMemory":
        return FramesInMemory()

    @cached_property
    def _other_parameters(self) -> list[str]:
        """Numbers with which the run was computed that differ from the scene's."""
        return engine_called(self.engine).other_parameters(self.path, self.problem)

    def _begun_as_the_scene(self, blocks: Iterator[Trajectory]) -> Iterator[Trajectory]:
        """Frames of the scene's atoms, whose parameters, times and first state are tested as they are read."""
        begun = False
        try:
            for block in blocks:
                if not begun:
                    self._refuse(self._other_parameters or _of_another_start(block))
                begun = True
                yield block
        except recording.OtherTimesError as error:
            self._refuse(self._other_parameters)
            raise RunError(f"{error}; {_ADVICE}") from None

    def _refuse(self, differences: list[str]) -> None:
        """Raise an error that says what differs from the scene, if anything does."""
        if differences:
            texts = "; ".join(differences)
            raise RunError(f"{self.path}: its frames are not those of {file_names.SCENE}: {texts}; {_ADVICE}")

    @property
    def trajectory(self) -> Trajectory:
        """The whole trajectory in memory."""
        return joined(self.blocks())


_ADVICE = "for other values, change the scene and run it again"


def _of_another_start(block: Trajectory) -> list[str]:
    """Sentences on what differs in the first frame of a run from the start of the scene."""
    if block.time[0] != 0.0:
        return [f"they begin at t = {block.problem.scale.written(block.time[0], 'time')} instead of 0"]
    return start.differences(block)


class FramesInMemory:
    """Frames of a small run, kept from one reading to the next while its files stay as they are."""

    def __init__(self) -> None:
        self._files: list[tuple[int, int, int]] = []
        self._blocks: list[Trajectory] = []

    def frames(self, dumps: list[Path], problem: Problem) -> Iterator[Trajectory]:
        """The frames of files, from memory where these are the ones that were read before."""
        state = _state(dumps)
        if self._blocks and self._files == state:
            yield from self._blocks
            return
        blocks = []
        for block in recording.blocks(dumps, problem):
            for values in (block.time, block.displacement, block.velocity):
                values.flags.writeable = False
            blocks.append(block)
            yield block
        if sum(block.frames for block in blocks) == problem.frames + 1 and state == _state(dumps):
            self._files, self._blocks = state, blocks


def _state(dumps: list[Path]) -> list[tuple[int, int, int]]:
    """Number, size and time of each file, which change when it is written to or replaced."""
    try:
        stats = [path.stat() for path in dumps]
    except OSError:
        return []  # reading says why
    return [(stat.st_ino, stat.st_size, stat.st_mtime_ns) for stat in stats]


def digested(blocks: Iterable[Trajectory], digest: "hashlib._Hash") -> Iterator[Trajectory]:
    """Consecutive frames of a run, which a digest takes on the way: that of all is their fingerprint, see `results`."""
    for block in blocks:
        add_frames(digest, block)
        yield block


def add_frames(digest: "hashlib._Hash", block: Trajectory) -> None:
    """Add the next frames of a run to the digest of those before."""
    frames = states(block)
    if not block.problem.rows.follow:
        digest.update(np.ascontiguousarray(frames).data)
    else:
        for state in frames:
            digest.update(np.int64(block.first).tobytes() + state.tobytes())


def results(directory: RunDirectory) -> dict[str, Any]:
    """Number of frames and a fingerprint of them, for ``run.json``.

    The fingerprint is the SHA-256 of displacement and velocity [chain, bead] (of a window, after the number of its
    first row) as little-endian float64, frame after frame: neither ranks nor interruptions change it.

    Args:
        directory: directory of the run.

    Returns:
        ``frames`` and ``sha256``.

    Raises:
        InputError: there are no frames.
    """
    digest = hashlib.sha256()
    frames = sum(block.frames for block in digested(directory.blocks(), digest))
    return {"frames": frames, "sha256": digest.hexdigest()}


def states(block: Trajectory) -> Floats:
    """Frames as one array [frame, displacement or velocity, chain, bead], in units of L and V; zeros have no sign."""
    stacked = np.stack([block.displacement, block.velocity], axis=1)
    stacked += 0.0
    return stacked


def fingerprint(files: dict[str, str]) -> str:
    """SHA-256 over a run's input files in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        content = files[name].encode()
        digest.update(f"{name}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()
