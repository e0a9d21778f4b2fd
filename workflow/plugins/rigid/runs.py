"""Runs of rigid beads: what the engine refuses, its files and its record."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from granchain import Scene
from granchain.parts import (
    Fact,
    Problem,
    engines,
    file_names,
    impulses,
    job,
    physics,
    quantity,
    write_frames,
    write_text,
)
from workflow.plugins.rigid.events import EVENTS, Collisions, from_csv, from_events


class RoundingRecord(job.RecordPart):
    """First collision that follows rounding: its number and that of the striking bead, from 1; time in scene's unit."""

    collision: job.Count
    row: job.Count
    time: job.Number


class RigidRecord(job.Job):
    """What ``run.json`` holds of a run of rigid beads.

    Attributes:
        collisions: their number.
        rounding: where they begin to follow rounding.
    """

    collisions: job.Count | None = None
    rounding: RoundingRecord | None = None


class RigidEngine(engines.Engine):
    """Collisions of rigid beads."""

    name = "collisions"
    title = "the engine of rigid beads"
    files = (*engines.Engine.files, EVENTS)
    table = EVENTS, Collisions
    record = RigidRecord

    def refusal(self, scene: Scene) -> str:
        """All but beads of equal mass with a gap, and equal linear springs between neighbouring chains."""
        system, other = scene.system, "use lammps or reference"
        if common := super().refusal(scene):
            return common
        if not isinstance(system.mass, float):
            return f"`collisions` is for beads of equal mass only; {other}"
        if physics.acted_on(system):
            return f"`collisions` has no push and no drive; {other}"
        if system.dampers:
            return f"`collisions` has no damping; {other}"
        if system.start is not None:
            return f"`collisions` starts from kicks alone; {other}"
        if system.closing:
            return f"`collisions` is for chains with ends; {other}"
        if not physics.simply_coupled(system):
            return f"`collisions` is for equal linear springs between neighbouring chains only; {other}"
        gaps = np.atleast_2d(system.along[0].gap)
        if not np.all(gaps > 0.0):
            return (
                "`collisions` moves rigid beads, which need a gap between all of them; give the scene `gap: ...`, or "
                f"{other}"
            )
        if physics.coupled(system) and np.any(np.ptp(gaps, axis=0)):
            return f"`collisions` has springs between chains of the same gaps only; {other}"
        return ""

    def problem(self, scene: Scene) -> Problem:
        """The problem of the scene with beads that do not overlap."""
        problem = scene.problem()
        system = replace(problem.system, lacks=problem.system.lacks | {Fact.OVERLAPS})
        return replace(problem, system=system)

    def compute(self, work: engines.Work) -> dict[str, Any]:
        """Every collision, and the frames of the exact motion between them."""
        # numba takes a third of a second to import
        from workflow.plugins.rigid import engine, rounding

        path, problem = work.path, work.problem
        engine.run(problem, max_events=0)  # loads or compiles
        started = time.perf_counter()
        try:
            run = engine.run(problem)
        except KeyboardInterrupt:
            return {"outcome": "interrupted", "steps_done": 0}
        seconds = time.perf_counter() - started
        rounded = rounding.by_rounding(run)
        marks, first = rounded.collisions.astype(np.int64), rounded.first
        events = Collisions(run.time, run.chain, run.row, run.striker, run.target, marks)
        write_text(path / EVENTS, quantity.csv_of(events, problem.scale))
        ending = write_frames(path / file_names.DUMP, problem, engine.blocks(run), work.progress)
        if ending["outcome"] != "done":
            return ending
        computed = {**ending, "engine_seconds": seconds, "collisions": len(run)}
        if first is None:
            return computed
        time_of_first = problem.scale.measured(float(run.time[first]), "time")
        return computed | {"rounding": {"collision": first + 1, "row": int(run.row[first]), "time": time_of_first}}

    def sentence(self, job: job.Job) -> str:
        """Number of collisions and time, with a warning where they follow rounding."""
        assert isinstance(job, RigidRecord)
        seconds = f"{job.engine_seconds:.2g} s"
        line = f"{job.collisions} collisions of rigid beads were computed in {seconds}; events.csv lists them"
        return line if job.rounding is None else f"{line}\nwarning: {_of_rounding(job.rounding)}"

    def errors(self, job: job.Job) -> tuple[float, float] | None:
        """None: the motion is exact between collisions."""
        del job
        return None

    def is_complete(self, job: job.Job) -> bool:
        """Whether a run came to its end."""
        return job.outcome == "done"

    def impulses(self, path: Path, problem: Problem, until: float | None = None) -> impulses.Impulses:
        """Impulses by the collisions that ``events.csv`` lists."""
        collisions = from_csv(path / EVENTS, problem.scale)
        return from_events(problem, collisions if until is None else collisions.until(until))

    def rounded_from(self, job: job.Job) -> float | None:
        """Time in the scene's unit of the first collision that follows rounding; None where none does."""
        return job.rounding.time if isinstance(job, RigidRecord) and job.rounding is not None else None


def _of_rounding(record: RoundingRecord) -> str:
    """Sentence on the collisions of rigid beads that follow rounding, with the first of them."""
    return (
        f"from collision {record.collision} on (row {record.row}) the collisions follow rounding: "
        "a change of the gap by 4e-15 of it changes displacements by more than 0.001 of the gap or impulses by more "
        "than 0.001 m V; events.csv marks these, and nothing that depends on them is a property of the scene"
    )


RIGID = RigidEngine()
