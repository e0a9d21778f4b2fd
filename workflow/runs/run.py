"""Run a scene: from its validated description to a run directory with everything in it."""

import contextlib
import functools
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

from analysis.files import events
from analysis.files.recording import Writer
from analysis.trajectory import Trajectory
from lammps_inputs import InputError, Problem, Scene
from lammps_inputs.decks import continuation, deck
from workflow.engines.lammps import engine as lammps_engine
from workflow.engines.reference import engine as reference
from workflow.errors import EndedError, RunError
from workflow.prepare.settings import Settings, certifiers, refuse_too_large, settle
from workflow.runs import check as checking
from workflow.runs import contacts
from workflow.runs.locks import alone
from workflow.runs.own_files import prepare, refuse_links, replacing
from workflow.runs.results import results
from workflow.runs.run_directory import EVENTS, RunDirectory, run_files
from workflow.runs.whole_files import write_text

Progress = Callable[[int, int], None]

Start = Callable[..., lammps_engine.Outcome]
"""Runs the deck in a directory, given ``ranks`` and ``progress``."""

LAMMPS_BYTES = 1000
"""Of memory, a bead; measured."""

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
    force: bool = False,
    settings: Settings | None = None,
    check: bool = True,
    progress: Progress | None = None,
    restart_every: float = lammps_engine.RESTART_EVERY,
    lammps: Start | None = None,
) -> Run:
    """Run a scene in a new directory.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        engine: "lammps", "reference" for the in-house integrator, or "collisions" for rigid beads.
        ranks: MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
        force: whether LAMMPS may run with a time step above the stability bound.
        settings: how the scene's time step was chosen, where `workflow.prepare.settings.settle` has done so before.
        check: whether to measure the error of a LAMMPS run against the reference when it is done.
        progress: called now and then with the steps done and the bead that the front has reached.
        restart_every: seconds of LAMMPS's work that a kill may cost: what `workflow.runs.resume` goes on from.
        lammps: how the deck is run; by default by LAMMPS in a process of its own.

    Raises:
        InputError: the directory, engine, number of ranks or time step cannot be used.
        RunError: the run failed; ``run.json`` says why.
    """
    path = Path(directory)
    if engine not in ENGINES:
        raise InputError(f"--engine: {engine!r} given; {', '.join(ENGINES[:-1])} or {ENGINES[-1]}")
    if engine == "lammps":
        refuse_too_large(scene, scene.name, LAMMPS_BYTES, "LAMMPS")
    scene, found_settings = settle(scene, source=scene.name, force=force or engine != "lammps")
    settings = found_settings or settings
    problem = scene.problem()
    refuse_what_it_cannot_do(engine, problem)
    lammps_engine.check_ranks(ranks, problem)
    if engine != "lammps" and ranks > 1:
        raise InputError(f"--ranks: the engine {engine!r} runs on one core")
    files = deck.render(scene)
    if engine != "lammps":
        files = {deck.SCENE: files[deck.SCENE]}
    names = run_files(engine)
    prepare(path, names, overwrite=overwrite)
    with alone(path) as lock:
        with replacing(path, names):
            write_text(path / deck.SCENE, files[deck.SCENE])
            result = RunDirectory(path)
            result.update_record(
                outcome="running",
                engine=engine,
                ranks=ranks,
                steps=problem.steps,
                **provenance(),
                files_sha256=fingerprint(files),
                scene=scene.resolved().plain(),
                **({"settings": settings.plain()} if settings is not None else {}),
                **({"force": True} if force else {}),
            )
            for name, text in files.items():
                write_text(path / name, text)
        start = lammps or functools.partial(lammps_engine.run, restart_every=restart_every, lock=lock)
        return carry_out(result, start=start, ranks=ranks, settings=settings, check=check, progress=progress)


def carry_out(
    result: RunDirectory,
    *,
    start: Start,
    ranks: int,
    settings: Settings | None,
    check: bool,
    progress: Progress | None,
    spent: float = 0.0,
) -> Run:
    """Compute what a directory was prepared for, and record how it ended.

    Args:
        result: the directory, with its record.
        start: how LAMMPS is run.
        ranks: as of `run`.
        settings: as of `run`.
        check: as of `run`.
        progress: as of `run`.
        spent: wall time of earlier attempts, which this one goes on from.

    Raises:
        InputError: something in the directory that it would write to is a link.
        RunError: the run failed; ``run.json`` says why, where the disk takes it.
    """
    path, problem, engine = result.path, result.problem, result.record["engine"]
    refuse_links(path)
    started = time.perf_counter() - spent
    if check and engine == "lammps":
        # on another core while LAMMPS computes
        threading.Thread(target=reference.load, daemon=True).start()
    try:
        if engine == "lammps":
            ending = _run_lammps(result, ranks, progress, start)
        elif engine == "reference":
            ending = _run_reference(path / deck.DUMP, problem, settings, progress)
        else:
            ending = _run_collisions(path, problem, progress)
        if ending["outcome"] == "done":
            ending["results"] = results(result)
            hardest = contacts.measure(result)
            if hardest is not None:
                ending["contacts"] = hardest.plain()
        result.update_record(**ending, wall_seconds=time.perf_counter() - started)
    except (RunError, OSError) as error:
        reason = str(error) if isinstance(error, RunError) else f"{path}: cannot be written ({error.strerror})"
        with contextlib.suppress(RunError):  # a full disk
            result.update_record(outcome="failed", reason=reason, wall_seconds=time.perf_counter() - started)
        if isinstance(error, OSError | EndedError):
            reason = f"{reason.rstrip('.')}; `granchain run --resume {path}` goes on from there"
        raise type(error)(reason) if isinstance(error, RunError) else RunError(reason) from None
    if ending["outcome"] != "done":
        return Run(result, ending["outcome"])
    for name in (continuation.RESTART, continuation.RESTART_SUMS):
        (path / name).unlink(missing_ok=True)
    return Run(result, "done", measure_error(result, settings) if check else None)


def measure_error(result: RunDirectory, settings: Settings | None) -> checking.Check | None:
    """Compare a run that is done with the reference, and record what was found; None if LAMMPS did not run."""
    if result.record["engine"] != "lammps":
        return None
    found = checking.check(result, settings)
    result.update_record(check=found.plain())
    return found


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
    """Write the reference's frames as LAMMPS would, certified to the accuracy if one is asked for."""
    started = time.perf_counter()
    for certifier in certifiers(problem, settings):
        ending = _write_frames(dump, problem, certifier.blocks(), progress)
        if ending["outcome"] != "done":
            return ending
        certificate = certifier.certificate
        if settings is None or certificate.velocity <= settings.accuracy:
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
        InputError: rigid beads were asked for, and the scene has no gap; or a window, and not of LAMMPS.
    """
    if engine != "lammps" and problem.window is not None:
        raise InputError(f"--engine: only lammps records a window, not {engine}; leave `window` out of the scene")
    if engine == "collisions" and not problem.simply_coupled:
        raise InputError(
            "--engine: `collisions` knows only linear springs between neighbouring chains; use lammps or reference"
        )
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
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": [os.fsencode(word).decode("utf-8", "replace") for word in sys.argv],
        "host": platform.node(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "python": platform.python_version(),
        "versions": _versions(),
    }


@functools.cache
def _versions() -> dict[str, str]:
    """Looked up once, since a process of a sweep runs many scenes."""
    names = ("granchain", "lammps", "numpy", "MDAnalysis", "matplotlib", "numba", "scipy", "pydantic")
    return {name: importlib.metadata.version(name) for name in names}
