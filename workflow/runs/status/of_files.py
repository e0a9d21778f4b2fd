"""What the files alone say: of a deck that nobody's record is about, or of what another command has made."""

import time
from pathlib import Path
from typing import Any

from lammps_inputs import file_names
from workflow.cluster.queue import Queued
from workflow.runs.files import parts
from workflow.runs.status.signs import fresh, last_step_of, locked, newest_frame, steps_of, written_here
from workflow.runs.status.state import State, Status
from workflow.runs.study_directory import sentence


def of_study(directory: Path, study: dict[str, Any]) -> Status:
    """What another command than ``run`` has made, by its ``run.json``."""
    why = sentence(study)
    if study["done"]:
        return Status(directory, "done", why=why)
    if locked(directory):
        return Status(directory, "running", why=why)
    return Status(directory, "incomplete", why=why)


def of_files(directory: Path, queued: Queued | None) -> Status:
    """A deck that was run by hand, or not at all."""
    steps, step = steps_of(directory), last_step_of(directory)
    if queued is not None:
        state: State = "waiting" if queued.waiting else "running"
        return Status(directory, state, step, steps, f"job {queued.number}")
    if not (directory / file_names.DECK).is_file():
        if (directory / file_names.SCENE).is_file():
            why = "nothing was computed; run it again with --overwrite"
            return Status(directory, "incomplete", None, None, why)
        return Status(directory, "none", why=f"it has no {file_names.SCENE}")
    if not parts(directory):
        start = (
            f"`sbatch {file_names.JOB}` there"
            if (directory / file_names.JOB).is_file()
            else f"`lmp -in {file_names.DECK}` there"
        )
        if (directory / file_names.JOB_INPUT).is_file() and not (directory / file_names.JOB).is_file():
            start = f"`sbatch {file_names.JOB}` beside {file_names.CASES}"
        return Status(directory, "written", 0, steps, f"{start} starts it")
    if step is not None and steps is not None and step >= steps:
        return Status(directory, "done", step, steps)
    onwards = f"`lmp -in {file_names.DECK}` there starts it from the beginning"
    if (directory / file_names.RESTART).is_file():
        onwards = f"`lmp -in {file_names.CONTINUE}` there resumes it"
    if locked(directory):
        return Status(directory, "running", step, steps)
    if not fresh(directory):
        return Status(directory, "incomplete", step, steps, f"cut; {onwards}")
    here = written_here(directory)
    if here:
        return Status(directory, "running", step, steps)
    age = f"its last frame is {time.time() - newest_frame(directory):.0f} s old"
    if here is None:
        return Status(directory, "running", step, steps, f"{age}; if no lmp runs any more, {onwards}")
    why = f"{age}, and no process on this machine writes it; unless one on another machine does, {onwards}"
    return Status(directory, "incomplete", step, steps, why)
