"""Run a scene: from its validated description to a run directory with everything in it."""

import hashlib
import importlib.metadata
import os
import platform
import sys
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from analysis import events
from analysis.recording import Writer
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, Problem, Scene, deck
from workflow import check as checking
from workflow.ending import with_duration
from workflow.engines.lammps import engine as lammps_engine
from workflow.engines.reference import engine as reference
from workflow.engines.reference.certify import Certifier
from workflow.errors import RunError
from workflow.run_directory import EVENTS, RunDirectory, prepare, write_text

Progress = Callable[[int, int], None]

ENGINES = ("lammps", "reference", "collisions")


@dataclass(frozen=True)
class Run:
    """A run that came to an end.

    Attributes:
        directory: everything that it left.
        outcome: "done", or "interrupted" with the frames until then.
        check: its error against the reference; None if that was not asked for, or another engine than LAMMPS ran.
    """

    directory: RunDirectory
    outcome: str
    check: checking.Check | None = None

    @property
    def trajectory(self) -> Trajectory:
        """All frames; read from the disk when asked for."""
        return self.directory.trajectory


def run(
    scene: Scene,
    directory: Path | str,
    *,
    engine: str = "lammps",
    ranks: int = 1,
    overwrite: bool = False,
    check: bool = True,
    progress: Progress | None = None,
) -> Run:
    """Run a scene in a new directory.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        engine: "lammps", "reference" for the in-house integrator, or "collisions" for rigid beads.
        ranks: MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
        check: whether to measure the error of a LAMMPS run against the reference when it is done.
        progress: called now and then with the steps done and the bead that the front has reached.

    Raises:
        InputError: the directory, engine or number of ranks cannot be used.
        RunError: the run failed; ``run.json`` says why.
    """
    path = Path(directory)
    if engine not in ENGINES:
        raise InputError(f"--engine: {engine!r} given; {', '.join(ENGINES[:-1])} or {ENGINES[-1]}")
    scene = with_duration(scene)
    problem = scene.problem()
    refuse_what_it_cannot_do(engine, problem)
    lammps_engine.check_ranks(ranks, problem)
    if engine != "lammps" and ranks > 1:
        raise InputError(f"--ranks: the engine {engine!r} runs on one core")
    files = deck.render(scene)
    if engine != "lammps":
        files = {deck.SCENE: files[deck.SCENE]}
    prepare(path, overwrite=overwrite)
    for name, text in files.items():
        write_text(path / name, text)
    result = RunDirectory(path)
    started = time.perf_counter()
    result.update_record(outcome="running", engine=engine, ranks=ranks, steps=problem.steps, **provenance())
    result.update_record(files_sha256=fingerprint(files))
    if check and engine == "lammps":
        # on another core while LAMMPS computes
        threading.Thread(target=reference.load, daemon=True).start()
    try:
        if engine == "lammps":
            ending = _run_lammps(path, ranks, progress)
        elif engine == "reference":
            ending = _run_reference(path / deck.DUMP, problem, progress)
        else:
            ending = _run_collisions(path, problem, progress)
    except RunError as error:
        result.update_record(outcome="failed", reason=str(error), wall_seconds=time.perf_counter() - started)
        raise
    result.update_record(**ending, wall_seconds=time.perf_counter() - started)
    found = None
    if check and engine == "lammps" and ending["outcome"] == "done":
        found = checking.check(result)
        result.update_record(check=found.plain())
    return Run(result, ending["outcome"], found)


def _run_lammps(path: Path, ranks: int, progress: Progress | None) -> dict[str, Any]:
    end = lammps_engine.run(path, ranks=ranks, progress=progress)
    outcome = "done" if end.end == "done" else "interrupted"
    return {"outcome": outcome, "steps_done": end.steps, "lammps": end.version, "engine_seconds": end.seconds}


def _run_reference(dump: Path, problem: Problem, progress: Progress | None) -> dict[str, Any]:
    """Write the reference's frames as LAMMPS would."""
    certifier = Certifier(problem)
    started = time.perf_counter()
    ending = _write_frames(dump, problem, certifier.blocks(), progress)
    if ending["outcome"] != "done":
        return ending
    seconds = time.perf_counter() - started
    certificate = asdict(certifier.certificate)
    return {**ending, "engine_seconds": seconds, "certificate": certificate}


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
    ending = _write_frames(path / deck.DUMP, problem, collisions.blocks(found), progress)
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


def refuse_what_it_cannot_do(engine: str, problem: Problem) -> None:
    """Say so before anything runs.

    Raises:
        InputError: rigid beads were asked for, and the scene has no gap.
    """
    if engine == "collisions" and not problem.gap > 0.0:
        raise InputError(
            "--engine: `collisions` moves rigid beads, which need a gap between them; "
            "give the scene `gap: ...`, or use lammps or reference"
        )


def _front(block: Trajectory) -> int:
    moving = (abs(block.velocity[-1]) > 1e-3).any(axis=0).nonzero()[0]
    return int(block.beads[moving[-1]]) if len(moving) else 1


def fingerprint(files: dict[str, str]) -> str:
    """SHA-256 over a run's input files in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(files):
        content = files[name].encode()
        digest.update(f"{name}\n{len(content)}\n".encode() + content)
    return digest.hexdigest()


def provenance() -> dict[str, Any]:
    """What is needed to tell where and with what something was computed."""
    names = ("granchain", "lammps", "numpy", "MDAnalysis", "matplotlib", "numba", "scipy", "pydantic")
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": sys.argv,
        "host": platform.node(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": {name: importlib.metadata.version(name) for name in names},
    }
