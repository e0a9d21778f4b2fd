"""What an engine is: what computes a run in a directory that was prepared for it, and what it refuses.

Each is an entry point of the group ``granchain.engines``: place in lists, and name = instance of `Engine`.

Examples:
    >>> reference = engines.engine_called("reference")
    >>> isinstance(reference, engines.Engine), reference.title
    (True, 'the reference integrator')
    >>> reference.refused_ranks(2, granchain.load("one-chain").problem().system)
    "the engine 'reference' runs on one core; 2 given"
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from analysis.trajectory import Trajectory
from lammps_inputs import Problem, Scene, file_names
from lammps_inputs.library import render_scene
from lammps_inputs.system import System
from workflow.engines.registry import load_engine
from workflow.prepare.step_choice import ChosenStep
from workflow.runs.files import RECORD
from workflow.runs.job import Job

if TYPE_CHECKING:
    from analysis.conservation import FrameAccountant
    from analysis.sharing.impulses import Impulses

Progress = Callable[[int, int], None]

Start = Callable[..., Any]
"""Runs the deck in a directory, with the arguments and the result of `workflow.engines.lammps.engine.run_deck`."""


@dataclass(frozen=True)
class Work:
    """What an engine is to compute.

    Attributes:
        path: a directory that was prepared for it.
        problem: what is computed.
        settings: how its time step was chosen for an accuracy, if one was asked for.
        progress: called now and then.
        ranks: number of MPI ranks.
        part: number of the file of frames to write; 1 begins at the start, a later one at the restart in the directory.
        restart_every: seconds of work that a kill may cost; the engine's usual ones where it is None.
        lock: file descriptor that keeps others out of the directory, for processes that the engine starts.
        seconds: wall time of the engine in earlier attempts, which this one continues.
        lammps: how LAMMPS is run; in a process of its own where it is None.
    """

    path: Path
    problem: Problem
    settings: ChosenStep | None = None
    progress: Progress | None = None
    ranks: int = 1
    part: int = 1
    restart_every: float | None = None
    lock: int | None = None
    seconds: float = 0.0
    lammps: Start | None = None


class Engine(ABC):
    """What computes a run.

    Attributes:
        name: in commands and records.
        title: in sentences.
        own_step: whether it computes with the time step of the scene, so that its error is measured by the reference.
        inputs: names of the files that it begins with.
        files: what it may leave in a run's directory before it is analysed.
        table: a CSV file among these, and the type whose fields declare its columns; None where there is none.
        record: type of what ``run.json`` holds of its runs.
        bytes_a_bead: memory in bytes that it needs for each bead; 0 where no run is refused for that.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    own_step: ClassVar[bool] = False
    inputs: ClassVar[tuple[str, ...]] = (file_names.SCENE,)
    files: ClassVar[tuple[str, ...]] = (file_names.SCENE, RECORD, file_names.DUMP)
    table: ClassVar[tuple[str, Any] | None] = None
    record: ClassVar[type[Job]] = Job
    bytes_a_bead: ClassVar[float] = 0.0

    def refusal(self, scene: Scene) -> str:
        """Why it cannot compute a scene; empty where it can."""
        none = scene.window is None
        return "" if none else f"only lammps records a window, not {self.name}; leave `window` out of the scene"

    def refused_ranks(self, ranks: int, system: System) -> str:  # noqa: ARG002  of the beads ask those that divide them
        """Why it cannot run a system on a number of ranks; empty where it can."""
        return "" if ranks == 1 else f"the engine {self.name!r} runs on one core; {ranks} given"

    def begins_with(self, scene: Scene, problem: Problem | None = None) -> dict[str, str]:  # noqa: ARG002  decks need it
        """Name and text of the files that it begins with; the problem is the scene's."""
        return {file_names.SCENE: render_scene(scene)}

    def problem(self, scene: Scene) -> Problem:
        """The dimensionless problem that it computes."""
        return scene.problem()

    def seconds(self, problem: Problem, ranks: int) -> float | None:  # noqa: ARG002  those that have an estimate use both
        """Estimated time of a run; None where there is no estimate."""
        return None

    @abstractmethod
    def compute(self, work: Work) -> dict[str, Any]:
        """Compute the frames of a run; how it ended, for ``run.json``.

        Raises:
            RunError: the engine failed.
            OSError: a file could not be written.
        """

    @abstractmethod
    def sentence(self, job: Job) -> str:
        """A sentence on what was computed, by the record of a run that came to its end."""

    @abstractmethod
    def errors(self, job: Job) -> tuple[float, float] | None:
        """Bounds on the errors of peak velocities (V) and of arrivals (T) by the account; None where it has none."""

    def is_complete(self, job: Job) -> bool:
        """Whether a run came to its end, and its error was measured if it has one."""
        return job.outcome == "done" and self.errors(job) is not None

    def impulses(self, path: Path, problem: Problem, until: float | None = None) -> "Impulses | None":
        """Impulses of contacts in a run whose frames hold no overlaps (`Fact.OVERLAPS`); None of all others.

        Args:
            path: directory of the run.
            problem: its problem.
            until: time of the last contacts, in units of T; None for all.
        """
        del path, problem, until
        return None

    def other_parameters(self, path: Path, problem: Problem) -> list[str]:
        """Sentences on numbers with which a run was computed, and that differ from those of its problem."""
        del path, problem
        return []

    def blocks(
        self, problem: Problem, *, rows: int | None = None, most_frames: int | None = None
    ) -> Iterator[Trajectory]:
        """Frames of a problem in consecutive blocks, computed in memory.

        Args:
            problem: what is computed.
            rows: rows that are computed at most, letting go of those farthest behind; None for all.
            most_frames: frames of a block at most.

        Raises:
            NotImplementedError: it computes in a directory alone.
        """
        del problem, rows, most_frames
        raise NotImplementedError(f"{self.title} computes in a directory")

    def accountant(self, frames: Problem, run: Problem | None = None, job: Job | None = None) -> "FrameAccountant":
        """Accountant that follows frames of any engine with this one.

        Args:
            frames: problem of the frames, all of a run or some.
            run: problem of that run; None for that of the frames.
            job: its record; None where there is none.

        Raises:
            NotImplementedError: it computes in a directory alone.
        """
        del frames, run, job
        raise NotImplementedError(f"{self.title} computes in a directory")

    def rounded_from(self, job: Job) -> float | None:
        """Time in the scene's unit from which rounding decides the motion; None where it does not."""
        del job
        return None


def engine_called(name: str) -> Engine:
    """An engine by its name.

    Raises:
        InputError: there is none.

    Examples:
        >>> engine_called("reference").title
        'the reference integrator'
        >>> engine_called("refrence").title
        Traceback (most recent call last):
            ...
        lammps_inputs.errors.InputError: --engine: 'refrence' given; lammps, reference or collisions
    """
    engine: Engine = load_engine(name)
    return engine
