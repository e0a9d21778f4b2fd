"""What a local run's record (``run.json``) says, beside the frames and the lock."""

import platform
import shlex
from pathlib import Path
from typing import Any

from workflow.runs.status.signs import clean, fresh, goes_on, last_step_of, latest, locked, number_of, steps_of
from workflow.runs.status.state import Status


def of_record(directory: Path, record: dict[str, Any]) -> Status:
    """State of a directory by its record, which a killed run leaves as it was while it ran."""
    steps = number_of(record.get("steps")) or steps_of(directory)
    outcome = record.get("outcome")
    done = number_of(record.get("steps_done"))
    if outcome == "done":
        return Status(directory, "done", steps if done is None else done, steps)
    step = latest(done, last_step_of(directory))
    if outcome == "failed":
        return Status(directory, "failed", step, steps, clean(record.get("reason", "")))
    onwards = f"`granchain run --resume {shlex.quote(str(directory))}` {goes_on(directory)}"
    if record.get("engine", "lammps") != "lammps":
        onwards = "run it again with --overwrite"
    if outcome == "interrupted":
        return Status(directory, "incomplete", step, steps, f"interrupted; {onwards}")
    if locked(directory):
        return Status(directory, "running", step, steps)
    if record.get("host") != platform.node() and fresh(directory):
        return Status(directory, "running", step, steps, f"on {clean(record.get('host'))}, it seems: it still writes")
    return Status(directory, "incomplete", step, steps, f"killed; {onwards}")
