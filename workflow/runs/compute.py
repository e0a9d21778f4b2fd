"""What each engine does in a run directory that was prepared for it, and what it cannot do."""

import time
from collections.abc import Callable, Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analysis.files import events
from analysis.files.recording import Writer
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, Problem, file_names
from workflow.engines.lammps import engine as lammps_engine
from workflow.prepare.settings import Settings
from workflow.runs.files import EVENTS
from workflow.runs.references import certifiers, closing
from workflow.runs.run_directory import RunDirectory
from workflow.runs.whole_files import write_text

Progress = Callable[[int, int], None]

Start = Callable[..., lammps_engine.Outcome]
"""Runs the deck in a directory, given ``ranks`` and ``progress``."""

ENGINES = ("lammps", "reference", "collisions")


def refuse_what_it_cannot_do(engine: str, problem: Problem) -> None:
    """Say so before anything runs.

    Raises:
        InputError: rigid beads were asked for, and the scene has no gap; or a window, and not of LAMMPS.
    """
    if engine != "lammps" and problem.window is not None:
        raise InputError(f"--engine: only lammps records a window, not {engine}; leave `window` out of the scene")
    if engine == "collisions" and not isinstance(problem.mass, float):
        raise InputError("--engine: `collisions` knows only beads of equal mass; use lammps or reference")
    if engine == "collisions" and not problem.simply_coupled:
        if problem.acted_on:
            raise InputError("--engine: `collisions` knows no push and no drive; use lammps or reference")
        if problem.dampers:
            raise InputError("--engine: `collisions` knows no damping; use lammps or reference")
        raise InputError(
            "--engine: `collisions` knows only equal linear springs between neighbouring chains; "
            "use lammps or reference"
        )
    if engine == "collisions" and not problem.gap > 0.0:
        raise InputError(
            "--engine: `collisions` moves rigid beads, which need a gap between them; "
            "give the scene `gap: ...`, or use lammps or reference"
        )


def compute(
    engine: str, result: RunDirectory, *, ranks: int, settings: Settings | None, progress: Progress | None, start: Start
) -> dict[str, Any]:
    """Let an engine compute the frames of a directory that was prepared for it; how it ended, for ``run.json``.

    Raises:
        RunError: the engine failed.
        OSError: a file could not be written.
    """
    path, problem = result.path, result.problem
    if engine == "lammps":
        return _run_lammps(result, ranks, progress, start)
    if engine == "reference":
        return _run_reference(path / file_names.DUMP, problem, settings, progress)
    return _run_collisions(path, problem, progress)


def _run_lammps(result: RunDirectory, ranks: int, progress: Progress | None, start: Start) -> dict[str, Any]:
    end = start(result.path, ranks=ranks, progress=progress)
    return {
        "outcome": "done" if end.end == "done" else "interrupted",
        "steps_done": end.steps,
        "lammps": end.version,
        "engine_seconds": end.seconds + result.record.get("engine_seconds", 0.0),
    }


def _run_reference(
    dump: Path, problem: Problem, settings: Settings | None, progress: Progress | None
) -> dict[str, Any]:
    """Write the reference's frames as LAMMPS would, certified to the accuracy if one is asked for.

    Where none is, and energy is exchanged, in as many steps as close its budget.
    """
    started = time.perf_counter()
    for certifier in closing(problem) if settings is None else certifiers(problem, settings):
        ending = _write_frames(dump, problem, certifier.blocks(), progress)
        if ending["outcome"] != "done":
            return ending
        certificate = certifier.certificate
        if settings is not None and certificate.velocity <= settings.accuracy:
            break
    seconds = time.perf_counter() - started
    return {**ending, "engine_seconds": seconds, "certificate": asdict(certificate)}


def _run_collisions(path: Path, problem: Problem, progress: Progress | None) -> dict[str, Any]:
    """Write every collision, and the frames of the exact motion between them as LAMMPS would."""
    # numba takes a third of a second to import
    from workflow.engines import collisions

    collisions.run(problem, max_events=0)  # loads or compiles
    started = time.perf_counter()
    try:
        found = collisions.run(problem)
    except KeyboardInterrupt:
        return {"outcome": "interrupted", "steps_done": 0}
    seconds = time.perf_counter() - started
    table = events.Events(found.time, found.chain, found.row, found.striker, found.target)
    write_text(path / EVENTS, events.to_csv(table, problem.scale))
    ending = _write_frames(path / file_names.DUMP, problem, collisions.blocks(found), progress)
    if ending["outcome"] != "done":
        return ending
    return {**ending, "engine_seconds": seconds, "collisions": len(found)}


def _write_frames(
    dump: Path, problem: Problem, blocks: Iterable[Trajectory], progress: Progress | None
) -> dict[str, Any]:
    """Write frames as LAMMPS would, to the end or to Ctrl-C; how it ended."""
    step = 0
    with Writer(dump, problem) as writer:
        try:
            for block in blocks:
                for displacement, velocity in zip(block.displacement, block.velocity, strict=True):
                    writer.append(step, displacement, velocity)
                    step += problem.steps_per_frame
                if progress is not None:
                    progress(step - problem.steps_per_frame, _front(block))
        except KeyboardInterrupt:
            return {"outcome": "interrupted", "steps_done": max(0, step - problem.steps_per_frame)}
    return {"outcome": "done", "steps_done": problem.steps}


def _front(block: Trajectory) -> int:
    moving = (abs(block.velocity[-1]) > 1e-3).any(axis=0).nonzero()[0]
    return int(block.beads[moving[-1]]) if len(moving) else 1
