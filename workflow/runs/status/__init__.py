"""In what state a directory is: every one has a name, also after a kill, and what to do next is said.

`of_job`, `of_record` and `of_files` ask a job's own account (``job.state``), a local run's (``run.json``), or the files
alone; `signs` are the frames, the lock of a run under way, and what was just written. Slurm's queue is asked where
there is one. Nothing is written.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, file_names
from workflow.cluster.queue import Queue
from workflow.runs.files import RECORD
from workflow.runs.record import read_record
from workflow.runs.status.of_files import of_files, of_study
from workflow.runs.status.of_job import of_job, read_state
from workflow.runs.status.of_record import of_record
from workflow.runs.status.signs import last_step_of, steps_of
from workflow.runs.status.state import MEANING, State, Status

__all__ = ["MEANING", "State", "Status", "status", "statuses"]


def statuses(directories: Sequence[Path], queue: Queue | None) -> list[Status]:
    """State of each directory; one that holds runs stands for them all."""
    return [status(found, queue) for directory in directories for found in _cases(directory)]


def _cases(directory: Path) -> list[Path]:
    try:
        if (directory / file_names.SCENE).exists() or not directory.is_dir():
            return [directory]
        listed = directory / file_names.CASES
        names = listed.read_text(encoding="utf-8").splitlines() if listed.is_file() else []
        cases = [directory / name for name in names if name]
        others = (path for path in sorted(directory.iterdir()) if (path / file_names.SCENE).is_file())
        return [*cases, *(path for path in others if path not in cases)] or [directory]
    except (OSError, ValueError):
        return [directory]


def status(directory: Path, queue: Queue | None = None) -> Status:
    """State of one directory.

    Args:
        directory: any path.
        queue: what Slurm says; None where there is none to ask.
    """
    try:
        return _status(directory, queue)
    except OSError as error:
        return Status(directory, "none", why=f"cannot be read ({error.strerror})")


def _status(directory: Path, queue: Queue | None) -> Status:
    if not directory.is_dir():
        return Status(directory, "none", why="no such directory")
    queued = queue.job_in(directory) if queue is not None else None
    told, recorded = directory / file_names.JOB_STATE, directory / RECORD
    record: dict[str, Any] | None = {}
    if recorded.is_file():
        try:
            record = read_record(recorded)
        except InputError:
            record = None
    account = record is None or "outcome" in record  # else it only lists what is in the directory
    if told.is_file() and not (account and recorded.stat().st_mtime > told.stat().st_mtime):
        return of_job(directory, read_state(told), queue, queued)
    if record is None:
        return Status(directory, "failed", last_step_of(directory), steps_of(directory), f"{RECORD} cannot be read")
    if account:
        return of_record(directory, record)
    study = record.get("study")
    return of_files(directory, queued) if study is None else of_study(directory, study)
