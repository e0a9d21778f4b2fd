"""What can be seen in a run's directory: how far its frames are, whether something holds it or has just written there.

Half-written and damaged files are nobody's mistake here: what cannot be read tells nothing.
"""

import re
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from analysis.files.dump_layout import last_step
from lammps_inputs import InputError, file_names
from workflow.engines.lammps.restarts import step_of
from workflow.runs.files import RECORD, parts
from workflow.runs.locks import held
from workflow.runs.record import read_record

GRACE = 600.0
"""Seconds after a job's time limit at which it has surely ended; also those in which a living run writes something."""


def steps_of(directory: Path) -> int | None:
    """Number of steps that the deck asks for; None if it cannot be read."""
    try:
        with (directory / file_names.DECK).open(encoding="utf-8", errors="replace") as file:
            head = file.read(1 << 16)
    except OSError:
        return None
    found = re.search(r"^variable steps index ([0-9]{1,18})\b", head, flags=re.MULTILINE)
    return int(found[1]) if found else None


def last_step_of(directory: Path) -> int | None:
    """Step of the last whole frame of all parts; None if there is none, or they cannot be read."""
    return latest(*(last_step(path) for path in parts(directory)))


def latest(*steps: int | None) -> int | None:
    """The largest of those that are known."""
    return max((step for step in steps if step is not None), default=None)


def goes_on(directory: Path) -> str:
    """Where a run that was cut goes on."""
    step = step_of(directory / file_names.RESTART)
    return f"goes on from step {step}" if step else "starts again, for there is no restart yet"


def locked(directory: Path) -> bool:
    """Whether a run holds the directory; without locks, whether it seems so."""
    found = held(directory)
    return fresh(directory) if found is None else found


def _only_lists(path: Path) -> bool:
    try:
        return path.is_file() and "outcome" not in read_record(path)
    except InputError:
        return False


def fresh(directory: Path) -> bool:
    """Whether something was written in the last minutes."""
    files = [*parts(directory), directory / RECORD]
    if _only_lists(files[-1]):  # which is news of reports, not of the run
        files.pop()
    return any(time.time() - path.stat().st_mtime < GRACE for path in files if path.exists())


def newest_frame(directory: Path) -> float:
    """When a frame was last written; there is one."""
    return max(path.stat().st_mtime for path in parts(directory))


def written_here(directory: Path) -> bool | None:
    """Whether a process on this machine has frames open; None where the system does not say."""
    frames = {path.resolve() for path in parts(directory)}
    processes = list(Path("/proc").glob("[0-9]*/fd"))
    for opened in processes:
        with suppress(OSError):  # it has ended, or is another user's
            for link in opened.iterdir():
                with suppress(OSError):  # it was closed
                    if link.readlink() in frames:
                        return True
    return False if processes else None


def clean(reason: Any) -> str:
    """One line that does nothing to a terminal."""
    return "".join(sign if sign.isprintable() else " " for sign in str(reason)[:300]).strip()


def number_of(value: Any) -> int | None:
    """A whole number from a file; None if it is none."""
    try:
        return int(value)
    except (TypeError, ValueError, OverflowError):
        return None
