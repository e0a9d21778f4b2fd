"""In what state a directory is: every one has a name, also after a kill, and what to do next is said.

Derived from a local run's own account (``run.json``), the report of a job, or the files alone, and from
the frames, the lock of a run under way, and what was just written. Jobs are known to plug-ins, as entry points of the
group ``granchain.queues``: modules with

- ``queue()``: the `Queue` of the cluster; None where no scheduler answers;
- ``state(reached, queue, since)``: `Status` of a directory (`Reached`) by what its job reports; None where it reports
  nothing, or nothing after ``since``, in seconds since 1970;
- ``submission(directory)``: how the directory's job is submitted, in words; None where it holds no job.

Nothing is written. Half-written and damaged files raise nothing here: what cannot be read is skipped.

Examples:
    >>> scene_files.write(granchain.load("one-chain"), tmp)
    >>> status.status(tmp).state
    'written'
    >>> status.Reached(tmp).steps
    32000
    >>> status.Queue("cluster", [status.Queued("17", True, tmp)]).job("17").waiting
    True
"""

import platform
import re
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from analysis.files.dump_layout import last_step
from lammps_inputs import InputError, file_names, plugins
from workflow.engines.lammps.files_on_disk import step_of
from workflow.runs.files import RECORD, held, parts
from workflow.runs.job import Job, StudyRecord, goes_on_from, load, onwards

# --- a scheduler's queue ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Queued:
    """A job or task of an array: its number, whether it still waits, and the directory that it works in."""

    number: str
    waiting: bool
    directory: Path


@dataclass(frozen=True)
class Queue:
    """The jobs of a cluster.

    Attributes:
        cluster: its name.
        jobs: all that wait or run.
    """

    cluster: str
    jobs: list[Queued] = field(default_factory=list)

    def job(self, number: str) -> Queued | None:
        """The job of a number, if it waits or runs."""
        return next((job for job in self.jobs if job.number == number), None)

    def job_in(self, directory: Path) -> Queued | None:
        """A job of a directory; one that runs before one that waits."""
        resolved = directory.resolve()
        jobs = [job for job in self.jobs if job.directory == resolved]
        return min(jobs, key=lambda job: job.waiting, default=None)


def cluster_queue() -> Queue | None:
    """The queue of the first cluster that answers; None where there is none."""
    answers = (jobs.queue() for jobs in plugins.loaded("queues").values())
    return next((answer for answer in answers if answer is not None), None)


# --- states -----------------------------------------------------------------------------------------------------------

State = Literal["none", "written", "waiting", "running", "done", "failed", "incomplete"]

MEANING: dict[State, str] = {
    "none": "holds no run",
    "written": "a deck or a job that has not been run",
    "waiting": "in the queue",
    "running": "computes",
    "done": "came to its end",
    "failed": "ended with an error",
    "incomplete": "was interrupted, and can be resumed",
}

GRACE = 600.0
"""Seconds in which a living run writes something."""


@dataclass(frozen=True)
class Status:
    """State of a directory.

    Attributes:
        directory: as it was given.
        state: one of `MEANING`.
        step: the last one; None where unknown.
        steps: number of steps of the run; None where unknown.
        why: the reason, and what to do next.
    """

    directory: Path
    state: State
    step: int | None = None
    steps: int | None = None
    why: str = ""

    def plain(self) -> dict[str, Any]:
        """Plain data of the state, for JSON."""
        return {**vars(self), "directory": str(self.directory)}


@dataclass(frozen=True)
class Reached:
    """How far the run of a directory has come, by its frames and its restart."""

    directory: Path

    @cached_property
    def step(self) -> int | None:
        """The last step; None where unknown."""
        return _last_step(self.directory)

    @cached_property
    def steps(self) -> int | None:
        """Number of steps of the run; None where unknown."""
        return _steps(self.directory)

    @cached_property
    def resumes(self) -> str:
        """The step from which an incomplete run resumes, in words."""
        return goes_on_from(self.directory)


def statuses(directories: Sequence[Path], queue: Queue | None) -> list[Status]:
    """State of each directory; one that holds runs stands for them all, and for the study that made them."""
    return [status(case, queue) for directory in directories for case in _cases(directory)]


def _cases(directory: Path) -> list[Path]:
    try:
        if (directory / file_names.SCENE).exists() or not directory.is_dir():
            return [directory]
        listed = directory / file_names.CASES
        names = listed.read_text(encoding="utf-8").split() if listed.is_file() else []
        cases = [directory / name for name in names if name]
        others = (path for path in sorted(directory.iterdir()) if (path / file_names.SCENE).is_file())
        of_study = [directory] if _study(directory) is not None else []
        return [*of_study, *cases, *(path for path in others if path not in cases)] or [directory]
    except (OSError, ValueError):
        return [directory]


def _study(directory: Path) -> StudyRecord | None:
    with suppress(InputError):
        return load(directory / RECORD).study
    return None


def status(directory: Path, queue: Queue | None = None) -> Status:
    """State of one directory.

    Args:
        directory: any path.
        queue: queue of the cluster; None where there is no scheduler.
    """
    try:
        return _status(directory, queue)
    except OSError as error:
        return Status(directory, "none", why=f"cannot be read ({error.strerror})")


def _status(directory: Path, queue: Queue | None) -> Status:
    if not directory.is_dir():
        return Status(directory, "none", why="no such directory")
    queued = queue.job_in(directory) if queue is not None else None
    record = directory / RECORD
    job = None
    with suppress(InputError):
        job = load(record)
    account = job is None or job.outcome is not None  # else it only lists what is in the directory
    reached = Reached(directory)
    since = record.stat().st_mtime if account else 0.0
    for jobs in plugins.loaded("queues").values():
        reported: Status | None = jobs.state(reached, queue, since)
        if reported is not None:
            return reported
    if job is None:
        return Status(directory, "failed", reached.step, reached.steps, f"{RECORD} cannot be read")
    if account:
        return _of_run(directory, job)
    if queued is not None and not (job.study and job.study.done):
        state: State = "waiting" if queued.waiting else "running"
        return Status(directory, state, reached.step, reached.steps, f"job {queued.number}")
    return _of_files(directory) if job.study is None else _of_study(directory, job.study)


def _of_run(directory: Path, job: Job) -> Status:
    """State of a local run by its account, which a kill leaves as it was while it ran."""
    steps = job.steps or _steps(directory)
    if job.outcome == "done":
        return Status(directory, "done", steps if job.steps_done is None else job.steps_done, steps)
    step = _latest(job.steps_done, _last_step(directory))
    if job.outcome == "failed":
        return Status(directory, "failed", step, steps, _clean(job.reason))
    if job.outcome == "interrupted":
        return Status(directory, "incomplete", step, steps, f"interrupted; {onwards(directory, job)}")
    if _locked(directory, directory / RECORD):
        return Status(directory, "running", step, steps)
    if job.host != platform.node() and _fresh(directory, directory / RECORD):
        return Status(directory, "running", step, steps, f"on {_clean(job.host)}, it seems: it still writes")
    return Status(directory, "incomplete", step, steps, f"killed, or its disk was full; {onwards(directory, job)}")


def _of_study(directory: Path, study: StudyRecord) -> Status:
    """State of a directory that another command than ``run`` made, by its account."""
    state: State = "done" if study.done else "running" if _locked(directory) else "incomplete"
    advice = study.result if study.done else study.resume
    return Status(directory, state, why=f"of `granchain {study.command}`; {advice}")


def _of_files(directory: Path) -> Status:
    """State of a deck that was run by hand or not at all, or of a study's job that was not submitted."""
    steps, step = _steps(directory), _last_step(directory)
    if not (directory / file_names.DECK).is_file():
        if (directory / file_names.SCENE).is_file():
            return Status(directory, "incomplete", why="nothing was computed; run it again with --overwrite")
        submission = _submission(directory)
        if submission is not None:
            return Status(directory, "written", why=f"{submission} starts it")
        return Status(directory, "none", why=f"it has no {file_names.SCENE}")
    if not parts(directory):
        start = _submission(directory) or f"`lmp -in {file_names.DECK}` there"
        return Status(directory, "written", 0, steps, f"{start} starts it")
    if step is not None and steps is not None and step >= steps:
        return Status(directory, "done", step, steps)
    onwards = f"`lmp -in {file_names.DECK}` there starts it from the beginning"
    if (directory / file_names.RESTART).is_file():
        onwards = f"`lmp -in {file_names.CONTINUE}` there resumes it"
    if _locked(directory):
        return Status(directory, "running", step, steps)
    if not _fresh(directory):
        return Status(directory, "incomplete", step, steps, f"cut; {onwards}")
    age = time.time() - max(path.stat().st_mtime for path in parts(directory))
    why = f"its last frame is {age:.0f} s old; if no lmp runs any more, {onwards}"
    return Status(directory, "running", step, steps, why)


def _submission(directory: Path) -> str | None:
    """How the job of a directory is submitted; None where it holds none."""
    answers = (jobs.submission(directory) for jobs in plugins.loaded("queues").values())
    return next((answer for answer in answers if answer is not None), None)


def _steps(directory: Path) -> int | None:
    """Number of steps that the deck asks for; None if it cannot be read."""
    try:
        with (directory / file_names.DECK).open(encoding="utf-8", errors="replace") as file:
            head = file.read(1 << 16)
    except OSError:
        return None
    match = re.search(r"^variable steps index ([0-9]{1,18})\b", head, flags=re.MULTILINE)
    return int(match[1]) if match else None


def _last_step(directory: Path) -> int | None:
    """Step of the last whole frame of all parts, or of the restart, which may be later; None if neither can be read."""
    return _latest(*(last_step(path) for path in parts(directory)), step_of(directory / file_names.RESTART))


def _latest(*steps: int | None) -> int | None:
    """The largest step; None where none is known."""
    return max((step for step in steps if step is not None), default=None)


def _locked(directory: Path, *account: Path) -> bool:
    """Whether a run holds the directory; without locks, whether it seems so."""
    locked = held(directory)
    return _fresh(directory, *account) if locked is None else locked


def _fresh(directory: Path, *account: Path) -> bool:
    """Whether frames or the account of a run were written in the last minutes."""
    files = (*parts(directory), *account)
    return any(time.time() - path.stat().st_mtime < GRACE for path in files if path.exists())


def _clean(reason: Any) -> str:
    """A reason as one line without control characters."""
    return "".join(sign if sign.isprintable() else " " for sign in str(reason)[:300]).strip()
