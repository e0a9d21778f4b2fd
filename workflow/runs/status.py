"""In what state a directory is: every one has a name, also after a kill, and what to do next is said.

A job's own account (``job.state``), a local run's (``run.json``), the frames, the lock of a run under way, and Slurm's
queue where there is one. Nothing is written.
"""

import platform
import re
import shlex
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from analysis.files.binary_dump import last_step
from lammps_inputs import InputError
from lammps_inputs.decks import continuation, deck
from lammps_inputs.slurm import job
from workflow.cluster.queue import Queue, Queued
from workflow.engines.lammps.restarts import step_of
from workflow.runs.locks import held
from workflow.runs.made_by import Made, made_by
from workflow.runs.record import RECORD, read_record
from workflow.runs.run_directory import parts

State = Literal["none", "written", "waiting", "running", "done", "failed", "incomplete"]

MEANING: dict[State, str] = {
    "none": "holds no run",
    "written": "a deck that has not been run",
    "waiting": "in the queue",
    "running": "computes",
    "done": "came to its end",
    "failed": "ended with an error",
    "incomplete": "was cut short, and can go on",
}

_GRACE = 600.0
"""Seconds after a job's time limit at which it has surely ended; also those in which a living run writes something."""


@dataclass(frozen=True)
class Status:
    """State of a directory.

    Attributes:
        directory: as it was given.
        state: one of `MEANING`.
        step: how far it is; None where nobody knows.
        steps: how far it is to go; likewise.
        why: the reason, and what to do next.
    """

    directory: Path
    state: State
    step: int | None = None
    steps: int | None = None
    why: str = ""

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "directory": str(self.directory),
            "state": self.state,
            "step": self.step,
            "steps": self.steps,
            "why": self.why,
        }


def statuses(directories: Sequence[Path], queue: Queue | None) -> list[Status]:
    """State of each directory; one that holds runs stands for them all."""
    return [status(found, queue) for directory in directories for found in _cases(directory)]


def _cases(directory: Path) -> list[Path]:
    try:
        if (directory / deck.SCENE).exists() or not directory.is_dir():
            return [directory]
        listed = directory / job.CASES
        names = listed.read_text(encoding="utf-8").splitlines() if listed.is_file() else []
        cases = [directory / name for name in names if name]
        others = (path for path in sorted(directory.iterdir()) if (path / deck.SCENE).is_file())
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
    told, recorded = directory / job.STATE, directory / RECORD
    record: dict[str, Any] | None = {}
    if recorded.is_file():
        try:
            record = read_record(recorded)
        except InputError:
            record = None
    account = record is None or "outcome" in record  # else it only lists what is in the directory
    if told.is_file() and not (account and recorded.stat().st_mtime > told.stat().st_mtime):
        return _of_job(directory, _read_state(told), queue, queued)
    if record is None:
        return Status(directory, "failed", _last_step(directory), _steps(directory), f"{RECORD} cannot be read")
    if account:
        return _of_record(directory, record)
    made = made_by(directory)
    return _of_files(directory, queued) if made is None else _of_many(directory, made)


# --- jobs -------------------------------------------------------------------------------------------------------------


def _read_state(path: Path) -> dict[str, str]:
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = file.read(1 << 14).splitlines()
    return {key: _clean(value) for key, _, value in (line.partition(" ") for line in lines)}


def _of_job(directory: Path, told: dict[str, str], queue: Queue | None, queued: Queued | None) -> Status:
    state, reason, number = told.get("state", ""), told.get("reason", ""), told.get("job", "")
    steps = _number(told.get("steps"))
    step = _number(told.get("step"))
    if state == "done":
        return Status(directory, "done", step, steps)
    here = queue is not None and queue.cluster == told.get("cluster")
    if queue is not None and here and queued is None:
        queued = queue.job(number)
    step = _latest(step, _last_step(directory))
    if queued is not None:
        if queued.waiting:
            return Status(directory, "waiting", step, steps, f"job {queued.number} is in the queue")
        return Status(directory, "running", step, steps, f"job {queued.number}" + (f", {reason}" if reason else ""))
    onwards = f"`sbatch {job.JOB}` there"
    if not (directory / job.JOB).is_file():
        onwards = f"`sbatch {job.JOB}` beside {job.CASES}"
    if state in ("waiting", "running") and here:
        why = f"job {number} is gone: killed, or its node lost; {onwards} {_from(directory)}"
        return Status(directory, "incomplete", step, steps, why)
    if state == "waiting":
        return Status(directory, "waiting", step, steps, f"job {number} {reason}, as it was told on {_when(told)}")
    if state == "running":
        if time.time() > (_number(told.get("ends")) or 0) + _GRACE:
            why = f"job {number} is past its time limit, so it was killed; {onwards} {_from(directory)}"
            return Status(directory, "incomplete", step, steps, why)
        return Status(directory, "running", step, steps, f"job {number}, as it was told on {_when(told)}")
    if state == "incomplete":
        return Status(directory, "incomplete", step, steps, f"{reason}; {onwards} {_from(directory)}")
    if state == "failed":
        return Status(directory, "failed", step, steps, f"{reason}; {onwards} tries again")
    return Status(directory, "failed", step, steps, f"{job.STATE} cannot be read; {onwards} tries again")


def _from(directory: Path) -> str:
    """Where a run that was cut goes on."""
    step = step_of(directory / continuation.RESTART)
    return f"goes on from step {step}" if step else "starts again, for there is no restart yet"


def _when(told: dict[str, str]) -> str:
    moment = time.localtime(_number(told.get("time")) or 0)
    return time.strftime("%Y-%m-%d %H:%M", moment) + f" by {told.get('host') or 'its node'}"


# --- local runs -------------------------------------------------------------------------------------------------------


def _of_record(directory: Path, record: dict[str, Any]) -> Status:
    steps = _number(record.get("steps")) or _steps(directory)
    outcome = record.get("outcome")
    done = _number(record.get("steps_done"))
    if outcome == "done":
        return Status(directory, "done", steps if done is None else done, steps)
    step = _latest(done, _last_step(directory))
    if outcome == "failed":
        return Status(directory, "failed", step, steps, _clean(record.get("reason", "")))
    onwards = f"`granchain run --resume {shlex.quote(str(directory))}` {_from(directory)}"
    if record.get("engine", "lammps") != "lammps":
        onwards = "run it again with --overwrite"
    if outcome == "interrupted":
        return Status(directory, "incomplete", step, steps, f"interrupted; {onwards}")
    if _locked(directory):
        return Status(directory, "running", step, steps)
    if record.get("host") != platform.node() and _fresh(directory):
        return Status(directory, "running", step, steps, f"on {_clean(record.get('host'))}, it seems: it still writes")
    return Status(directory, "incomplete", step, steps, f"killed; {onwards}")


def _locked(directory: Path) -> bool:
    """Whether a run holds the directory; without locks, whether it seems so."""
    found = held(directory)
    return _fresh(directory) if found is None else found


def _only_lists(path: Path) -> bool:
    try:
        return path.is_file() and "outcome" not in read_record(path)
    except InputError:
        return False


def _fresh(directory: Path) -> bool:
    """Whether something was written in the last minutes."""
    files = [*parts(directory), directory / RECORD]
    if _only_lists(files[-1]):  # which is news of reports, not of the run
        files.pop()
    return any(time.time() - path.stat().st_mtime < _GRACE for path in files if path.exists())


# --- neither ----------------------------------------------------------------------------------------------------------


def _of_many(directory: Path, made: Made) -> Status:
    """What another command than ``run`` has made."""
    if made.whole:
        return Status(directory, "done", why=made.why)
    if _newest(directory) > time.time() - _GRACE:
        return Status(directory, "running", why=f"or was cut a moment ago: its files are minutes old; {made.why}")
    return Status(directory, "incomplete", why=made.why)


def _newest(directory: Path) -> float:
    """When something was last written in a directory, or in those in it."""
    files = [path for pattern in ("*", "*/*", "*/*/*") for path in directory.glob(pattern)]
    return max((path.lstat().st_mtime for path in files), default=0.0)


def _of_files(directory: Path, queued: Queued | None) -> Status:
    """A deck that was run by hand, or not at all."""
    steps, step = _steps(directory), _last_step(directory)
    if queued is not None:
        state: State = "waiting" if queued.waiting else "running"
        return Status(directory, state, step, steps, f"job {queued.number}")
    if not (directory / deck.DECK).is_file():
        if (directory / deck.SCENE).is_file():
            why = "nothing was computed; run it again with --overwrite"
            return Status(directory, "incomplete", None, None, why)
        return Status(directory, "none", why=f"it has no {deck.SCENE}")
    if not parts(directory):
        start = f"`sbatch {job.JOB}` there" if (directory / job.JOB).is_file() else f"`lmp -in {deck.DECK}` there"
        if (directory / job.INPUT).is_file() and not (directory / job.JOB).is_file():
            start = f"`sbatch {job.JOB}` beside {job.CASES}"
        return Status(directory, "written", 0, steps, f"{start} starts it")
    if step is not None and steps is not None and step >= steps:
        return Status(directory, "done", step, steps)
    if _locked(directory) or _fresh(directory):
        return Status(directory, "running", step, steps, "or was cut a moment ago: its frames are minutes old")
    onwards = f"`lmp -in {deck.DECK}` there starts it anew"
    if (directory / continuation.RESTART).is_file():
        onwards = f"`lmp -in {continuation.CONTINUE}` there goes on"
    return Status(directory, "incomplete", step, steps, f"cut; {onwards}")


def _steps(directory: Path) -> int | None:
    try:
        with (directory / deck.DECK).open(encoding="utf-8", errors="replace") as file:
            head = file.read(1 << 16)
    except OSError:
        return None
    found = re.search(r"^variable steps index ([0-9]{1,18})\b", head, flags=re.MULTILINE)
    return int(found[1]) if found else None


def _last_step(directory: Path) -> int | None:
    """Step of the last whole frame of all parts; None if there is none, or they cannot be read."""
    return _latest(*(last_step(path) for path in parts(directory)))


def _latest(*steps: int | None) -> int | None:
    return max((step for step in steps if step is not None), default=None)


def _clean(reason: Any) -> str:
    """One line that does nothing to a terminal."""
    return "".join(sign if sign.isprintable() else " " for sign in str(reason)[:300]).strip()


def _number(value: Any) -> int | None:
    try:
        return int(value)
    except (TypeError, ValueError, OverflowError):
        return None
