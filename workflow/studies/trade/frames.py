"""What frames cost and what is lost in them: how often they are written, and in which format.

One LAMMPS run at the scene's time step, recorded in several ways. Errors are those of reading alone: against the very
same run, recorded often and exactly.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from analysis.files import recording
from analysis.tracking.peaks import PeakFinder, Peaks
from analysis.trajectory import Trajectory, frames_per_block
from lammps_inputs import Problem, file_names
from workflow.errors import RunError
from workflow.studies.trade import certified, jobs
from workflow.studies.trade.work_precision import Setting

TEXT = "chains.dump.txt"

BINARY = "binary"
FORMATS = {"text %g": "", "text %.17g": "dump_modify frames format float %.17g\n"}
"""Text formats, with the line that a deck needs for them."""

FARTHEST = 2.0
"""Time between frames from which on a wave falls between them."""

LEAST_FRAMES = 10

NEAR = 0.025
"""Time between the frames in which passages are taken to be found exactly: to 1e-9 of T and of V."""

MOST_BYTES = 400_000_000


@dataclass(frozen=True)
class Recording:
    """One way to record a run: its problem, with the frames, and a format."""

    problem: Problem
    format: str


@dataclass(frozen=True)
class Read:
    """A recorded run and what recording and reading it cost.

    Attributes:
        path: of the file.
        run, read: seconds of the time loop, and of getting all states from the file.
    """

    recording: Recording
    path: Path
    run: float
    read: float

    def blocks(self) -> Iterator[Trajectory]:
        """The frames, as the format has them."""
        problem = self.recording.problem
        return (
            recording.blocks([self.path], problem)
            if self.recording.format == BINARY
            else text_blocks(self.path, problem)
        )

    def costs(self) -> dict[str, float]:
        """By name."""
        size = self.path.stat().st_size
        return {"seconds": self.run + self.read, "run": self.run, "read": self.read, "bytes": float(size)}


def settings(problem: Problem) -> list[Setting[Recording]]:
    """Times between frames, in our format, and all formats at the scene's own."""
    steps = problem.steps_per_frame
    counts, finer = {steps * 2**power for power in range(8)}, divisors(problem)
    while len(finer) > 1:
        counts.add(finer[-1])
        finer = [count for count in finer if count <= finer[-1] // 2]
    found = [
        Setting("frames", own.every, f"every {own.every:.4g}", 1.0, Recording(own, BINARY))
        for own in (every(problem, count) for count in sorted(counts, reverse=True))
        if own.every <= FARTHEST and own.frames >= LEAST_FRAMES
    ]
    formats = (BINARY, *FORMATS) if 3 * _size(problem, steps) <= MOST_BYTES else ()
    return found + [
        Setting("format", float(number), name, 1.0, Recording(problem, name)) for number, name in enumerate(formats)
    ]


def divisors(problem: Problem) -> list[int]:
    """Steps from frame to frame, ascending, that record a run more often than the scene: the least is exact enough."""
    steps = problem.steps_per_frame
    fit = [count for count in range(1, steps + 1) if steps % count == 0 and _size(problem, count) <= MOST_BYTES]
    near = [count for count in fit if count * problem.timestep <= NEAR]
    least = max(near, default=min(fit, default=steps))
    return [count for count in fit if count % least == 0 and count < steps] or [steps]


def every(problem: Problem, steps: int) -> Problem:
    """The same run with a frame every so many steps."""
    return replace(problem, steps_per_frame=steps, frames=problem.steps // steps)


def _size(problem: Problem, steps: int) -> int:
    """Bytes of the frames in our format."""
    return problem.steps // steps * problem.chains * len(problem.recorded_beads) * 24


def run(job: Recording, directory: Path) -> Read:
    """Run LAMMPS, and read its frames once.

    Raises:
        RunError: LAMMPS failed.
    """

    def change(text: str) -> str:
        if job.format == BINARY:
            return text
        return text.replace(file_names.DUMP, TEXT).replace("\ndump_modify ", f"\n{FORMATS[job.format]}dump_modify ")

    seconds, _ = jobs.lammps(job.problem, directory, change=change)
    path = directory / (file_names.DUMP if job.format == BINARY else TEXT)
    read = Read(job, path, seconds, 0.0)
    started = time.perf_counter()
    for _ in read.blocks():
        pass
    return replace(read, read=time.perf_counter() - started)


def text_blocks(path: Path, problem: Problem) -> Iterator[Trajectory]:
    """Frames of a text dump ``id x vx``, by numpy, in blocks.

    Raises:
        RunError: it ends within a frame.
    """
    ids = recording.atom_ids(problem)
    rest = recording.rest_positions(problem)
    size = frames_per_block(problem)
    steps: list[int] = []
    states = []
    with path.open("rb") as file:
        for line in file:
            if line.startswith(b"ITEM: TIMESTEP"):
                steps.append(int(next(file)))
            elif line.startswith(b"ITEM: ATOMS"):
                values = np.fromstring(b"".join(islice(file, ids.size)), sep=" ")
                if values.size != 3 * ids.size:
                    raise RunError(f"{path}: ends within a frame")
                rows = values.reshape(-1, 3)
                states.append(rows[np.argsort(rows[:, 0], kind="stable")])
                if len(states) == size:
                    yield _block(problem, steps, states, ids.shape, rest)
                    steps, states = [], []
    if states:
        yield _block(problem, steps, states, ids.shape, rest)


def _block(
    problem: Problem, steps: list[int], states: list[certified.Floats], shape: tuple[int, ...], rest: certified.Floats
) -> Trajectory:
    rows = np.array(states).reshape(-1, *shape, 3)
    time = np.array(steps) / problem.steps_per_frame * problem.every
    return Trajectory(problem, time, rows[..., 1] - rest, rows[..., 2].copy())


@dataclass(frozen=True)
class Exact:
    """The run that all recordings are of, recorded often."""

    problem: Problem
    path: Path
    peaks: Peaks

    def errors(self, read: Read) -> certified.Errors:
        """Largest errors of reading; of velocities at the frames that there are."""
        stride = read.recording.problem.steps_per_frame // self.problem.steps_per_frame
        return certified.deviation(read.blocks(), recording.blocks([self.path], self.problem, stride), self.peaks)


def make_exact(problem: Problem, directory: Path) -> Exact:
    """Run LAMMPS at the scene's time step with frames no farther apart than `NEAR`, where that fits the disk.

    Raises:
        RunError: LAMMPS failed.
    """
    fine = every(problem, divisors(problem)[0])
    jobs.lammps(fine, directory)
    path = directory / "exact.bin"
    (directory / file_names.DUMP).replace(path)
    finder = PeakFinder(first_only=True)
    for block in recording.blocks([path], fine):
        finder.add(block)
    return Exact(fine, path, finder.result())
