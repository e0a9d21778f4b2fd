"""Resume a run that was interrupted, killed, or met a full disk."""

import os
import warnings
from datetime import UTC, datetime
from pathlib import Path

from analysis.files import recording
from analysis.files.binary_dump import BinaryDump, CutDumpWarning, NoFrameError
from lammps_inputs import InputError, Problem, file_names
from lammps_inputs.decks import continuation
from workflow.engines.lammps import files_on_disk
from workflow.prepare.step_choice import ChosenStep
from workflow.runs.completed_run import CompletedRun
from workflow.runs.engines import Progress, Start, Work, engine_called
from workflow.runs.files import RECORD, alone, part_number, parts, write_text
from workflow.runs.job import Job, restart_refused
from workflow.runs.output_directory import complete_replacement, refuse_links, refuse_unwritable
from workflow.runs.run import carry_out, measure_error
from workflow.runs.run_directory import RunDirectory, fingerprint

_AGAIN = "there is nothing to resume: run the scene again with another -o"


def resume(
    directory: Path | str,
    *,
    ranks: int | None = None,
    check: bool = True,
    progress: Progress | None = None,
    restart_every: float | None = None,
    lammps: Start | None = None,
) -> CompletedRun | None:
    """Bring a run to its end; bit for bit as if it had never been interrupted.

    LAMMPS resumes from the last restart, or from the start if there is none. Other engines start again.

    Args:
        directory: of a run that `workflow.runs.run.run` began.
        ranks: MPI ranks of LAMMPS; by default as many as before.
        check: as of `workflow.runs.run.run`.
        progress: as of `workflow.runs.run.run`.
        restart_every: as of `workflow.runs.run.run`.
        lammps: as of `workflow.runs.run.run`.

    Returns:
        The run, or None if it was done before.

    Raises:
        InputError: no run was begun there, its files were changed, or it is under way.
        RunError: the run failed.
    """
    path = Path(directory)
    begun(path)
    with alone(path) as lock:
        refuse_links(path)
        result, job = _with_its_files(path)
        settings, engine = settings_of(job), engine_called(result.engine)
        if job.outcome == "done":
            if job.check is not None or not check or not engine.own_step:
                return None
            return CompletedRun(result, "done", measure_error(result, settings))
        ranks = job.ranks or 1 if ranks is None else ranks
        if refusal := engine.refused_ranks(ranks, result.problem.system):
            raise InputError(f"--ranks: {refusal}")
        refuse_unwritable(path, parts(path))
        spent = _spent(path, job)
        part, step = _next_part(result, job) if engine.name == "lammps" else (1, 0)
        if part == 1:
            _remove_frames(path)
        else:
            write_text(path / file_names.CONTINUE, continuation.render_continuation(result.problem))
        now = datetime.now(UTC).isoformat(timespec="seconds")
        resumed = [*(earlier.plain() for earlier in job.resumed), {"at": now, "from_step": step}]
        result.update(outcome="running", reason=None, resumed=resumed, wall_seconds=spent)
        seconds = result.job.engine_seconds
        work = Work(path, result.problem, settings, progress, ranks, part, restart_every, lock, seconds, lammps)
        return carry_out(result, work, check=check, spent=spent)


def settings_of(job: Job) -> ChosenStep | None:
    """How a run's time step was chosen."""
    return None if job.settings is None else ChosenStep(**job.settings.plain())


def begun(path: Path) -> RunDirectory:
    """The run that was begun in a directory.

    Raises:
        InputError: none was.
    """
    complete_replacement(path)
    if path.is_dir() and not (path / file_names.SCENE).is_file():
        raise InputError(
            f"{path}: holds no {file_names.SCENE}, so no run was begun there; run the scene with -o {path}"
        )
    result = RunDirectory(path)
    try:
        job = result.job
    except InputError as error:
        raise InputError(f"{error}; {_AGAIN}") from None
    if None in (job.engine, job.outcome, job.ranks) or (job.outcome == "running" and job.started is None):
        raise InputError(f"{path}: holds no {RECORD} of a run; {_AGAIN}")
    return result


def _with_its_files(path: Path) -> tuple[RunDirectory, Job]:
    """The run in a directory and its account, with the files that it was begun with.

    Raises:
        InputError: they were changed.
    """
    result = begun(path)
    job, engine = result.job, engine_called(result.engine)
    # what is no text is not what was written either
    names = (*engine.inputs, file_names.TABLES)
    files = {name: (path / name).read_text("utf-8", "replace") for name in names if (path / name).is_file()}
    missing: list[str] = []
    if any(name not in files for name in engine.inputs):  # killed before all were there
        rendered = engine.begins_with(result.scene)
        missing = [name for name in rendered if name not in files]
        files |= {name: rendered[name] for name in missing}
    if fingerprint(files) != job.files_sha256:
        raise InputError(
            f"{path}: {', '.join(files)} are not those that the run was begun with; run the scene again with "
            "--overwrite"
        )
    for name in missing:
        write_text(path / name, files[name])
    return result, job


def _next_part(result: RunDirectory, job: Job) -> tuple[int, int]:
    """Number of the part of the frames to write next, and the step that it resumes from; the start is (1, 0).

    A restart is of use if LAMMPS is still the one that wrote it, and if all frames until then are there.
    """
    path = result.path
    step = files_on_disk.step_of(path / file_names.RESTART) if files_on_disk.intact(path / file_names.RESTART) else None
    if not step or restart_refused(job) or not _hold_all(parts(path), result.problem, step):
        return 1, 0
    _tidy(path)
    return max(part_number(file) for file in parts(path)) + 1, step


def _hold_all(files: list[Path], problem: Problem, step: int) -> bool:
    """Whether all frames until a step are there."""
    steps: set[int] = set()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)
        for file in files:
            try:
                steps.update(BinaryDump(file).steps.tolist())
            except NoFrameError:
                continue
            except InputError:  # damaged
                return False
        if not steps.issuperset(range(0, step + 1, problem.steps_per_frame)):
            return False
        try:
            for _ in recording.blocks(files, problem):  # whether each frame holds its beads
                pass
        except InputError:
            return False
    return True


def _tidy(path: Path) -> None:
    """End each file of frames after its last whole one."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)
        for file in parts(path):
            try:
                os.truncate(file, BinaryDump(file).whole_bytes)
            except NoFrameError:
                file.unlink()


def _remove_frames(path: Path) -> None:
    restart = (file_names.RESTART, file_names.RESTART_SUMS, file_names.UNFINISHED)
    for file in (*parts(path), *(path / name for name in restart)):
        file.unlink(missing_ok=True)


def _spent(path: Path, job: Job) -> float:
    """Wall time of all attempts; one that was killed lasted until the last that it wrote."""
    if job.outcome != "running":
        return job.wall_seconds
    begun_at = job.resumed[-1].at if job.resumed else str(job.started)
    mine = engine_called(job.engine or "lammps").files
    written = [file.stat().st_mtime for file in path.iterdir() if file.name in mine or part_number(file)]
    return job.wall_seconds + max(0.0, max(written) - datetime.fromisoformat(begun_at).timestamp())
