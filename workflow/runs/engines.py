"""The engines: what each computes in a run directory that was prepared for it, and what it refuses."""

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from analysis.files.events import Collisions
from analysis.files.recording import Writer
from analysis.quantity import csv_of
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, Problem, Scene, file_names, physics
from lammps_inputs.decks import deck, scene_files
from lammps_inputs.system import System
from workflow import cost_model as model
from workflow.engines.lammps import engine as lammps_engine
from workflow.prepare.step_choice import ChosenStep
from workflow.runs.check import closing, references_of
from workflow.runs.files import EVENTS, LAMMPS_FILES, RECORD, write_text
from workflow.runs.job import Job, RoundingRecord
from workflow.runs.run_directory import RunDirectory

Progress = Callable[[int, int], None]

Start = Callable[..., lammps_engine.LammpsOutcome]
"""Runs the deck in a directory, given ``problem`` and ``progress``."""


@dataclass(frozen=True)
class Work:
    """What an engine is to compute.

    Attributes:
        result: a directory that was prepared for it.
        settings: how its time step was chosen for an accuracy, if one was asked for.
        progress: called now and then.
        start: how LAMMPS is run.
    """

    result: RunDirectory
    settings: ChosenStep | None
    progress: Progress | None
    start: Start


class Engine(ABC):
    """What computes a run.

    Attributes:
        name: in commands and records.
        title: in sentences.
        own_step: whether it computes with the time step of the scene, so that its error is measured by the reference.
        deforms: whether beads have overlaps and forces.
        inputs: names of the files that it begins with.
        files: what it may leave in a run's directory before it is analysed.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    own_step: ClassVar[bool] = False
    deforms: ClassVar[bool] = True
    inputs: ClassVar[tuple[str, ...]] = (file_names.SCENE,)
    files: ClassVar[tuple[str, ...]] = (file_names.SCENE, RECORD, file_names.DUMP, EVENTS)

    def refusal(self, scene: Scene) -> str:
        """Why it cannot compute a scene; empty where it can."""
        none = scene.window is None
        return "" if none else f"only lammps records a window, not {self.name}; leave `window` out of the scene"

    def refused_ranks(self, ranks: int, system: System) -> str:  # noqa: ARG002  of the beads ask those that divide them
        """Why it cannot run a system on a number of ranks; empty where it can."""
        return "" if ranks == 1 else f"the engine {self.name!r} runs on one core; {ranks} given"

    def begins_with(self, scene: Scene, problem: Problem | None = None) -> dict[str, str]:  # noqa: ARG002  decks need it
        """Name and text of the files that it begins with; the problem is the scene's."""
        return {file_names.SCENE: scene_files.render_scene(scene)}

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


class _Lammps(Engine):
    name = "lammps"
    title = "LAMMPS"
    own_step = True
    inputs = (file_names.SCENE, file_names.DECK, file_names.DATA)
    files = LAMMPS_FILES

    def refusal(self, scene: Scene) -> str:
        return deck.refusal(scene.system)

    def refused_ranks(self, ranks: int, system: System) -> str:
        return lammps_engine.refused_ranks(ranks, system.beads)

    def begins_with(self, scene: Scene, problem: Problem | None = None) -> dict[str, str]:
        return scene_files.render(scene, problem)

    def seconds(self, problem: Problem, ranks: int) -> float | None:
        return model.cost(problem, ranks).seconds

    def compute(self, work: Work) -> dict[str, Any]:
        end = work.start(work.result.path, problem=work.result.problem, progress=work.progress)
        return {
            "outcome": "done" if end.end == "done" else "interrupted",
            "steps_done": end.steps,
            "lammps": end.version,
            "engine_seconds": end.seconds + work.result.job.engine_seconds,
        }

    def sentence(self, job: Job) -> str:
        ranks = f"{job.ranks} rank{'' if job.ranks == 1 else 's'}"
        if job.resumed:
            steps = ", ".join(str(again.from_step) for again in job.resumed)
            return (
                f"LAMMPS {job.lammps} computed {job.steps} steps in {job.wall_seconds:.2f} s on {ranks}, "
                f"resumed from step {steps}"
            )
        return f"LAMMPS {job.lammps} computed {job.steps} steps in {job.engine_seconds:.2f} s on {ranks}"

    def errors(self, job: Job) -> tuple[float, float] | None:
        return None if job.check is None else (_known(job.check.amplitude), _known(job.check.arrival))


class _Reference(Engine):
    name = "reference"
    title = "the reference integrator"

    def seconds(self, problem: Problem, ranks: int) -> float | None:  # noqa: ARG002  it runs on one core
        from workflow.engines.reference import engine  # numba takes a third of a second to import
        from workflow.prepare import pilot

        return model.REFERENCE_FORCE * pilot.work(problem, 0, engine.default_steps_per_frame(problem))

    def compute(self, work: Work) -> dict[str, Any]:
        """Compute to the accuracy if one is asked for; else, where energy is exchanged, until its budget is closed."""
        problem, settings, started = work.result.problem, work.settings, time.perf_counter()
        for halving in closing(problem) if settings is None else references_of(problem, settings):
            ending = write_frames(work.result.path / file_names.DUMP, problem, halving.blocks(), work.progress)
            if ending["outcome"] != "done":
                return ending
            uncertainty = halving.uncertainty
            if settings is not None and uncertainty.velocity <= settings.accuracy:
                break
        seconds = time.perf_counter() - started
        return {**ending, "engine_seconds": seconds, "uncertainty": asdict(uncertainty)}

    def sentence(self, job: Job) -> str:
        errors = self.errors(job)
        assert errors is not None
        return (
            f"the reference integrator computed the run in {job.engine_seconds:.2f} s; its uncertainty is "
            f"{errors[0]:.1e} V in velocities and {errors[1]:.1e} T in arrivals"
        )

    def errors(self, job: Job) -> tuple[float, float] | None:
        uncertainty = job.uncertainty
        return None if uncertainty is None else (_known(uncertainty.velocity), _known(uncertainty.arrival))


class _Collisions(Engine):
    name = "collisions"
    title = "the engine of rigid beads"
    deforms = False

    def refusal(self, scene: Scene) -> str:
        system, other = scene.system, "use lammps or reference"
        if common := super().refusal(scene):
            return common
        if not isinstance(system.mass, float):
            return f"`collisions` is for beads of equal mass only; {other}"
        if physics.acted_on(system):
            return f"`collisions` has no push and no drive; {other}"
        if system.dampers:
            return f"`collisions` has no damping; {other}"
        if not physics.simply_coupled(system):
            return f"`collisions` is for equal linear springs between neighbouring chains only; {other}"
        if not physics.gap(system) > 0.0:
            return (
                f"`collisions` moves rigid beads, which need a gap between them; give the scene `gap: ...`, or {other}"
            )
        return ""

    def compute(self, work: Work) -> dict[str, Any]:
        """Every collision, and the frames of the exact motion between them."""
        # numba takes a third of a second to import
        from workflow.engines import collisions

        path, problem = work.result.path, work.result.problem
        collisions.run(problem, max_events=0)  # loads or compiles
        started = time.perf_counter()
        try:
            run = collisions.run(problem)
        except KeyboardInterrupt:
            return {"outcome": "interrupted", "steps_done": 0}
        seconds = time.perf_counter() - started
        rounded = collisions.by_rounding(run)
        marks, first = rounded.collisions.astype(np.int64), rounded.first
        events = Collisions(run.time, run.chain, run.row, run.striker, run.target, marks)
        write_text(path / EVENTS, csv_of(events, problem.scale))
        ending = write_frames(path / file_names.DUMP, problem, collisions.blocks(run), work.progress)
        if ending["outcome"] != "done":
            return ending
        computed = {**ending, "engine_seconds": seconds, "collisions": len(run)}
        if first is None:
            return computed
        time_of_first = problem.scale.measured(float(run.time[first]), "time")
        return computed | {"rounding": {"collision": first + 1, "row": int(run.row[first]), "time": time_of_first}}

    def sentence(self, job: Job) -> str:
        seconds = f"{job.engine_seconds:.2g} s"
        line = f"{job.collisions} collisions of rigid beads were computed in {seconds}; events.csv lists them"
        return line if job.rounding is None else f"{line}\nwarning: {_of_rounding(job.rounding)}"

    def errors(self, job: Job) -> tuple[float, float] | None:  # noqa: ARG002  exact between collisions
        return None


def _of_rounding(record: RoundingRecord) -> str:
    """Sentence on the collisions of rigid beads that follow rounding, with the first of them."""
    return (
        f"from collision {record.collision} on (row {record.row}) the collisions follow rounding: "
        "a change of the gap by 4e-15 of it changes displacements by more than 0.001 of the gap or impulses by more "
        "than 0.001 m V; events.csv marks these, and nothing that depends on them is a property of the scene"
    )


LAMMPS, REFERENCE, RIGID = _Lammps(), _Reference(), _Collisions()

ENGINES: dict[str, Engine] = {engine.name: engine for engine in (LAMMPS, REFERENCE, RIGID)}


def engine_called(name: str) -> Engine:
    """An engine by its name.

    Raises:
        InputError: there is none.
    """
    if name not in ENGINES:
        *others, last = ENGINES
        raise InputError(f"--engine: {name!r} given; {', '.join(others)} or {last}")
    return ENGINES[name]


def _known(error: float | None) -> float:
    return math.nan if error is None else error


def write_frames(
    dump: Path, problem: Problem, blocks: Iterable[Trajectory], progress: Progress | None = None
) -> dict[str, Any]:
    """Write frames as LAMMPS would, to the end or to Ctrl-C; how it ended."""
    step = 0
    with Writer(dump, problem) as writer:
        try:
            for block in blocks:
                for state in block.states():
                    writer.append(step, *state)
                    step += problem.steps_per_frame
                if progress is not None:
                    progress(step - problem.steps_per_frame, _front(block))
        except KeyboardInterrupt:
            return {"outcome": "interrupted", "steps_done": max(0, step - problem.steps_per_frame)}
    return {"outcome": "done", "steps_done": problem.steps}


def _front(block: Trajectory) -> int:
    moving = (abs(block.velocity[-1]) > 1e-3).any(axis=0).nonzero()[0]
    return int(block.beads[moving[-1]]) if len(moving) else 1
