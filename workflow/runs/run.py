"""Run a scene: from its validated description to a run directory with everything in it."""

import contextlib
import contextvars
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict, Unpack

from lammps_inputs import InputError, Problem, Scene, file_names
from workflow.engines.reference import engine as reference
from workflow.errors import EndedError, RunError
from workflow.prepare.settings import refuse_too_large, refuse_unanalysable, settle
from workflow.prepare.step_choice import ChosenStep
from workflow.runs import check as checking
from workflow.runs import contacts, job
from workflow.runs.completed_run import Check, CompletedRun
from workflow.runs.engines import Progress, Start, Work, engine_called
from workflow.runs.output_directory import prepared, refuse_links, refuse_unusable
from workflow.runs.run_directory import RunDirectory, fingerprint, results
from workflow.runs.size import refuse_beforehand, refuse_too_long


class RunningOptions(TypedDict, total=False):
    """How a prepared run is computed.

    Attributes:
        check: whether to measure the error of a LAMMPS run against the reference when it is done, as by default.
        restart_every: seconds of LAMMPS's work that a kill may cost: what `workflow.runs.resume` resumes from.
        lammps: how the deck is run; by default by LAMMPS in a process of its own.
    """

    check: bool
    restart_every: float
    lammps: Start


@dataclass(frozen=True)
class PreparedRun:
    """A run that can begin: what its scene leaves open is determined, and nothing refuses it. Nothing is written yet.

    Attributes:
        scene: with duration, window, time step and all defaults.
        problem: the dimensionless problem that it stands for.
        step: how the time step was chosen; None where the scene names it, or the engine has none of its own.
        path: directory of the run.
        engine: name of the engine.
        ranks: MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
    """

    scene: Scene
    problem: Problem
    step: ChosenStep | None
    path: Path
    engine: str
    ranks: int
    overwrite: bool


def prepare_run(
    scene: Scene,
    directory: Path | str,
    *,
    engine: str = "lammps",
    ranks: int = 1,
    overwrite: bool = False,
    force: bool = False,
    source: str = "",
) -> PreparedRun:
    """Determine what a scene leaves open, and see that its run can begin; the one place that refuses it.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        engine: name of the engine, such as "lammps", or "reference" for the in-house integrator.
        ranks: MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
        force: whether LAMMPS may run with a time step above the stability bound.
        source: what the user calls the scene, for messages; by default its name.

    Returns:
        What `run_prepared` begins with; nothing is written yet.

    Raises:
        InputError: the directory, engine, number of ranks or time step cannot be used, or the run is too large.
    """
    path, chosen, source = Path(directory), engine_called(engine), source or scene.name
    for option, refusal in (
        ("--engine", chosen.refusal(scene)),
        ("--ranks", chosen.refused_ranks(ranks, scene.system)),
    ):
        if refusal:
            raise InputError(f"{option}: {refusal}")
    refuse_unanalysable(scene, source)
    refuse_unusable(path, chosen.files, overwrite=overwrite)
    refuse_beforehand(scene, source, chosen, ranks)
    if chosen.bytes_a_bead:
        refuse_too_large(scene, source, chosen.bytes_a_bead, chosen.title)
    settled, step = settle(scene, source=source, force=force, own_step=chosen.own_step)
    if step is not None and not chosen.own_step and not step.asked:
        step = None
    resolved = settled.resolved()
    problem = chosen.problem(resolved)
    refuse_too_long(resolved, source, chosen, ranks, problem)
    return PreparedRun(resolved, problem, step, path, engine, ranks, overwrite)


def run(
    scene: Scene,
    directory: Path | str,
    *,
    engine: str = "lammps",
    ranks: int = 1,
    overwrite: bool = False,
    force: bool = False,
    progress: Progress | None = None,
    **options: Unpack[RunningOptions],
) -> CompletedRun:
    """Run a scene in a new directory: `prepare_run`, then `run_prepared`.

    Args:
        scene: what to compute.
        directory: new or empty, or an earlier run's with ``overwrite``.
        engine: see `prepare_run`.
        ranks: MPI ranks of LAMMPS.
        overwrite: whether an earlier run's files may be replaced.
        force: whether LAMMPS may run with a time step above the stability bound.
        progress: called now and then with the steps done and the bead that the front has reached.
        **options: see `RunningOptions`.

    Returns:
        The run, done or interrupted.

    Raises:
        InputError: the directory, engine, number of ranks or time step cannot be used.
        RunError: the run failed; ``run.json`` says why.

    Examples:
        >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 5.0})
        >>> done = run(scene, tmp / "done", engine="reference")
        >>> done.outcome, done.trajectory.frames
        ('done', 51)
    """
    ready = prepare_run(scene, directory, engine=engine, ranks=ranks, overwrite=overwrite, force=force)
    return run_prepared(ready, progress=progress, **options)


def run_prepared(
    ready: PreparedRun, *, progress: Progress | None = None, **options: Unpack[RunningOptions]
) -> CompletedRun:
    """Write the directory of a prepared run, compute it, and measure its error.

    Args:
        ready: see `prepare_run`.
        progress: called now and then with the steps done and the bead that the front has reached.
        **options: see `RunningOptions`.

    Returns:
        The run, done or interrupted.

    Raises:
        InputError: the directory has been taken meanwhile.
        RunError: the run failed; ``run.json`` says why.
    """
    chosen, path = engine_called(ready.engine), ready.path
    files = chosen.begins_with(ready.scene, ready.problem)
    record = {
        "outcome": "running",
        "engine": ready.engine,
        "ranks": ready.ranks,
        "steps": ready.problem.steps,
        **job.provenance(),
        "files_sha256": fingerprint(files),
        "settings": None if ready.step is None else ready.step.plain(),
    }
    with prepared(path, files, chosen.files, overwrite=ready.overwrite, **record) as lock:
        run_directory = RunDirectory.begun_with(path, ready.scene, ready.problem)
        work = Work(
            path,
            ready.problem,
            ready.step,
            progress,
            ranks=ready.ranks,
            restart_every=options.get("restart_every"),
            lock=lock,
            lammps=options.get("lammps"),
        )
        return carry_out(run_directory, work, check=options.get("check", True))


@contextlib.contextmanager
def _interrupted_once() -> Iterator[None]:
    """Let only the first Ctrl-C, or what counts as one, interrupt: a second would prevent the record of the stop."""
    heard = (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT, signal.SIGHUP)
    before = [number for number in heard if signal.getsignal(number) is signal.default_int_handler]
    if threading.current_thread() is not threading.main_thread():
        before = []

    def first(*_: object) -> None:
        if not stopping:
            stopping.append(True)
            raise KeyboardInterrupt

    stopping: list[bool] = []

    for number in before:
        signal.signal(number, first)
    try:
        yield
    finally:
        for number in before:
            signal.signal(number, signal.default_int_handler)


@_interrupted_once()
def carry_out(result: RunDirectory, work: Work, *, check: bool, spent: float = 0.0) -> CompletedRun:
    """Compute what a directory was prepared for, and record how it ended.

    Args:
        result: the directory, with its record.
        work: what its engine is to compute in it.
        check: as of `run`.
        spent: wall time of earlier attempts, which this one continues.

    Returns:
        The run, done or interrupted.

    Raises:
        InputError: something in the directory that it would write to is a link.
        RunError: the run failed; ``run.json`` says why, where the disk takes it.
    """
    path, engine = result.path, engine_called(result.engine)
    refuse_links(path)
    started = time.perf_counter() - spent
    loading = None
    if check and engine.own_step:  # on another core while LAMMPS computes
        loading = threading.Thread(target=contextvars.copy_context().run, args=(reference.load,), daemon=True)
        loading.start()
    try:
        ending = engine.compute(work)
        if ending["outcome"] == "done":
            ending["results"] = results(result)
            overlaps = contacts.measure(result)
            if overlaps is not None:
                ending["contacts"] = overlaps.plain()
        result.update(**ending, wall_seconds=time.perf_counter() - started)
    except (RunError, OSError) as error:
        reason = str(error) if isinstance(error, RunError) else f"{path}: cannot be written ({error.strerror})"
        with contextlib.suppress(RunError):  # a full disk
            result.update(outcome="failed", reason=reason, wall_seconds=time.perf_counter() - started)
        if isinstance(error, OSError | EndedError):
            reason = f"{reason.rstrip('.')}; {job.onwards(path, result.job)}"
        raise type(error)(reason) if isinstance(error, RunError) else RunError(reason) from None
    finally:
        if loading is not None:
            loading.join()
    if ending["outcome"] != "done":
        return CompletedRun(result, ending["outcome"])
    for name in (file_names.RESTART, file_names.RESTART_SUMS):
        (path / name).unlink(missing_ok=True)
    return CompletedRun(result, "done", measure_error(result, work.settings) if check else None)


def measure_error(result: RunDirectory, settings: ChosenStep | None) -> Check | None:
    """Compare a run that is done with the reference, and record what was found; None where LAMMPS did not run."""
    if not engine_called(result.engine).own_step:
        return None
    measured = checking.check(result, settings)
    result.update(check=measured.plain())
    return measured
