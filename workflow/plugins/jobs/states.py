"""Jobs of a cluster: the queue of its scheduler, and states of directories by what their jobs report.

A module of the group ``granchain.queues`` (`workflow.runs.status`).
"""

import re
import subprocess
import time
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from granchain.parts import file_names, status
from workflow.plugins.jobs import job_files
from workflow.plugins.jobs.registry import SCHEDULERS
from workflow.plugins.jobs.schedulers import SLURM, ListedJob, Scheduler

ANSWER = 15.0
"""Seconds in which a scheduler is to answer."""

GRACE = 600.0
"""Seconds after a job's time limit at which it has surely ended."""


def queue() -> status.Queue | None:
    """The queue of the first scheduler that answers; None where there is none."""
    for scheduler in SCHEDULERS.values():
        answer = scheduler.queue(_output)
        if answer is not None:
            return queue_of(*answer)
    return None


def queue_of(cluster: str, listed: Sequence[ListedJob]) -> status.Queue:
    """The queue of the jobs that a scheduler lists; a task works in the directories of its line of cases.txt."""
    queue = status.Queue(cluster)
    lists: dict[Path, list[str]] = {}
    for job in listed:
        where = Path(job.directory)
        places = [where]
        if job.task is not None:
            if where not in lists:
                lists[where] = _lines(where / file_names.CASES)
            if job.task < len(lists[where]):
                places = [where / name for name in lists[where][job.task].split()]
        queue.jobs.extend(status.Queued(job.number, job.waiting, place.resolve()) for place in places)
    return queue


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return []


def _output(*words: str) -> str | None:
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=ANSWER, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout if done.returncode == 0 else None


# --- reports ----------------------------------------------------------------------------------------------------------

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
    return {} if line is None else {name: _printable(text) for name, text in line.groupdict().items()}


def _printable(text: str) -> str:
    """Text without control characters."""
    return "".join(sign if sign.isprintable() else " " for sign in text[:300]).strip()


def _seconds(moment: str) -> float:
    """Seconds since 1970 of a time with its zone; 0 if it cannot be read."""
    try:
        return datetime.fromisoformat(moment).timestamp()
    except (ValueError, OverflowError):
        return 0.0


def state(reached: status.Reached, queue: status.Queue | None, since: float) -> status.Status | None:
    """State of a directory by the report of its job; where the queue has the job, the queue is right.

    Args:
        reached: how far the run of the directory has come.
        queue: the cluster's queue.
        since: time of a local run there, in seconds since 1970: an earlier report does not count.
    """
    account = reached.directory / job_files.STATE
    if not account.is_file() or since > account.stat().st_mtime:
        return None
    queued = None if queue is None else queue.job_in(reached.directory)
    return _by_report(reached, account, queue, queued)


def _by_report(
    reached: status.Reached, account: Path, queue: status.Queue | None, queued: status.Queued | None
) -> status.Status:
    directory, steps, report = reached.directory, reached.steps, _report(account)
    state, number = report.get("state", ""), report.get("job", "")
    step = reached.step or 0
    if state == "done" or (not report and step == steps):  # jobs of version 0.1 wrote another report
        return status.Status(directory, "done", steps, steps)
    same_cluster = queue is not None and queue.cluster == report.get("cluster")
    if queue is not None and same_cluster and queued is None:
        queued = queue.job(number)
    if queued is not None:
        if queued.waiting:
            return status.Status(directory, "waiting", step, steps, f"job {queued.number} is in the queue")
        return status.Status(directory, "running", step, steps, f"job {queued.number}")
    again, goes_on = _how_submitted(directory), reached.resumes
    if not report:
        return status.Status(directory, "failed", step, steps, f"{account.name} cannot be read; {again} tries again")
    if state in ("waiting", "running") and same_cluster:
        why = f"job {number} is gone: killed, or its node lost; {again} {goes_on}"
        return status.Status(directory, "incomplete", step, steps, why)
    moment = time.localtime(_seconds(report["at"]))
    reported = time.strftime("as reported on %Y-%m-%d %H:%M", moment) + f" by {report['host']}"
    if state == "waiting":
        return status.Status(directory, "waiting", step, steps, f"job {number} {report['reason']}, {reported}")
    if state == "running":
        if time.time() > _seconds(report["until"]) + GRACE:
            why = f"job {number} is past its time limit, so it was killed; {again} {goes_on}"
            return status.Status(directory, "incomplete", step, steps, why)
        return status.Status(directory, "running", step, steps, f"job {number}, {reported}")
    if state == "incomplete":
        return status.Status(directory, "incomplete", step, steps, f"{report['reason']}; {again} {goes_on}")
    return status.Status(directory, "failed", step, steps, f"{report['reason']}; {again} tries again")


def submission(directory: Path) -> str | None:
    """How the job of a directory is submitted, in words; None where it holds none."""
    if _scheduler(directory) is None and not (directory / job_files.INPUT).is_file():
        return None
    return _how_submitted(directory)


def _how_submitted(directory: Path) -> str:
    """How a job is submitted, in words; a task of an array with its array."""
    scheduler = _scheduler(directory)
    if scheduler is not None:
        return f"`{scheduler.by_hand}` there"
    arrays = (parent for parent in directory.absolute().parents if (parent / file_names.CASES).is_file())
    scheduler = next(filter(None, map(_scheduler, arrays)), SLURM)
    return f"`{scheduler.by_hand}` beside {file_names.CASES}"


def _scheduler(directory: Path) -> Scheduler | None:
    """Scheduler of the job that a directory holds; None where it holds none."""
    return next((each for each in SCHEDULERS.values() if (directory / each.script).is_file()), None)
