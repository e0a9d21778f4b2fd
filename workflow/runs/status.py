"""In what state a directory is: every one has a name, also after a kill, and what to do next is said.

Derived from a local run's own account (``run.json``), a job's line (``job.state``), or the files alone, and from
the frames, the lock of a run under way, and what was just written. A scheduler's queue is asked where there is one.
Nothing is written. Half-written and damaged files raise nothing here: what cannot be read is skipped.
"""

import platform
import re
import subprocess
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

from analysis.files.dump_layout import last_step
from lammps_inputs import InputError, file_names
from workflow.engines.lammps.files_on_disk import step_of
from workflow.plugins.jobs.schedulers import SCHEDULERS, SLURM, ListedJob, Scheduler
from workflow.runs.files import RECORD, held, parts
from workflow.runs.job import Job, StudyRecord, load
from workflow.runs.resumption import goes_on_from, onwards

# --- a scheduler's queue ----------------------------------------------------------------------------------------------

_SECONDS = 15.0


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
    """The queue of the first scheduler that answers; None where there is none."""
    for scheduler in SCHEDULERS.values():
        answer = scheduler.queue(_output)
        if answer is not None:
            return queue_of(*answer)
    return None


def queue_of(cluster: str, listed: Sequence[ListedJob]) -> Queue:
    """The queue of the jobs that a scheduler lists; a task works in the directories of its line of cases.txt."""
    queue = Queue(cluster)
    lists: dict[Path, list[str]] = {}
    for job in listed:
        where = Path(job.directory)
        places = [where]
        if job.task is not None:
            if where not in lists:
                lists[where] = _lines(where / file_names.CASES)
            if job.task < len(lists[where]):
                places = [where / name for name in lists[where][job.task].split()]
        queue.jobs.extend(Queued(job.number, job.waiting, place.resolve()) for place in places)
    return queue


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return []


def _output(*words: str) -> str | None:
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=_SECONDS, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout if done.returncode == 0 else None


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
"""Seconds after a job's time limit at which it has surely ended; also those in which a living run writes something."""


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
    reported, recorded = directory / file_names.JOB_STATE, directory / RECORD
    job = None
    with suppress(InputError):
        job = load(recorded)
    account = job is None or job.outcome is not None  # else it only lists what is in the directory
    if reported.is_file() and not (account and recorded.stat().st_mtime > reported.stat().st_mtime):
        return _of_job(directory, reported, queue, queued)
    if job is None:
        return Status(directory, "failed", _last_step(directory), _steps(directory), f"{RECORD} cannot be read")
    if account:
        return _of_run(directory, job)
    if queued is not None and not (job.study and job.study.done):
        state: State = "waiting" if queued.waiting else "running"
        return Status(directory, state, _last_step(directory), _steps(directory), f"job {queued.number}")
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
        if _scheduler(directory) is not None:
            return Status(directory, "written", why=f"{_submit(directory)} starts it")
        return Status(directory, "none", why=f"it has no {file_names.SCENE}")
    if not parts(directory):
        start = f"`lmp -in {file_names.DECK}` there"
        if _scheduler(directory) is not None or (directory / file_names.JOB_INPUT).is_file():
            start = _submit(directory)
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


_REPORT = re.compile(
    r"(?P<state>running|waiting|incomplete|failed|done) job=(?P<job>\S*) cluster=(?P<cluster>\S*) host=(?P<host>\S*)"
    r" at=(?P<at>\S*) until=(?P<until>\S*) (?P<reason>.*)"
)
"""The line of ``job.state``: state of a run, job (the next one of a waiting run), cluster, node, when it was written,
time limit of the job, and why it ended.
"""


def _report(account: Path) -> dict[str, str]:
    """Fields of `_REPORT` by name; none if the file does not hold such a line."""
    with account.open(encoding="utf-8", errors="replace") as file:
        line = _REPORT.match(file.read(1 << 12))
    return {} if line is None else {name: _clean(text) for name, text in line.groupdict().items()}


def _seconds(moment: str) -> float:
    """Seconds since 1970 of a time with its zone; 0 if it cannot be read."""
    try:
        return datetime.fromisoformat(moment).timestamp()
    except (ValueError, OverflowError):
        return 0.0


def _of_job(directory: Path, account: Path, queue: Queue | None, queued: Queued | None) -> Status:
    """State of the directory of a job, by its account; where the queue has the job, the queue is right."""
    report, steps = _report(account), _steps(directory)
    state, number = report.get("state", ""), report.get("job", "")
    step = _latest(_last_step(directory), 0)
    if state == "done" or (not report and step == steps):  # jobs of version 0.1 wrote another report
        return Status(directory, "done", steps, steps)
    same_cluster = queue is not None and queue.cluster == report.get("cluster")
    if queue is not None and same_cluster and queued is None:
        queued = queue.job(number)
    if queued is not None:
        if queued.waiting:
            return Status(directory, "waiting", step, steps, f"job {queued.number} is in the queue")
        return Status(directory, "running", step, steps, f"job {queued.number}")
    again, goes_on = _submit(directory), goes_on_from(directory)
    if not report:
        return Status(directory, "failed", step, steps, f"{account.name} cannot be read; {again} tries again")
    if state in ("waiting", "running") and same_cluster:
        why = f"job {number} is gone: killed, or its node lost; {again} {goes_on}"
        return Status(directory, "incomplete", step, steps, why)
    moment = time.localtime(_seconds(report["at"]))
    reported = time.strftime("as reported on %Y-%m-%d %H:%M", moment) + f" by {report['host']}"
    if state == "waiting":
        return Status(directory, "waiting", step, steps, f"job {number} {report['reason']}, {reported}")
    if state == "running":
        if time.time() > _seconds(report["until"]) + GRACE:
            why = f"job {number} is past its time limit, so it was killed; {again} {goes_on}"
            return Status(directory, "incomplete", step, steps, why)
        return Status(directory, "running", step, steps, f"job {number}, {reported}")
    if state == "incomplete":
        return Status(directory, "incomplete", step, steps, f"{report['reason']}; {again} {goes_on}")
    return Status(directory, "failed", step, steps, f"{report['reason']}; {again} tries again")


def _submit(directory: Path) -> str:
    """How a job is submitted; a task of an array with its array."""
    scheduler = _scheduler(directory)
    if scheduler is not None:
        return f"`{scheduler.by_hand}` there"
    arrays = (parent for parent in directory.absolute().parents if (parent / file_names.CASES).is_file())
    scheduler = next(filter(None, map(_scheduler, arrays)), SLURM)
    return f"`{scheduler.by_hand}` beside {file_names.CASES}"


def _scheduler(directory: Path) -> Scheduler | None:
    """Scheduler of the job that a directory holds; None where it holds none."""
    return next((each for each in SCHEDULERS.values() if (directory / each.script).is_file()), None)


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
