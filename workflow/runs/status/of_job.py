"""What a Slurm job's own account (``job.state``) says, beside the queue and the frames."""

import time
from pathlib import Path

from lammps_inputs import file_names
from workflow.cluster.queue import Queue, Queued
from workflow.runs.status.signs import GRACE, clean, goes_on, last_step_of, latest, number_of
from workflow.runs.status.state import Status


def read_state(path: Path) -> dict[str, str]:
    """What a job last wrote of itself, by its keys."""
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = file.read(1 << 14).splitlines()
    return {key: clean(value) for key, _, value in (line.partition(" ") for line in lines)}


def of_job(directory: Path, told: dict[str, str], queue: Queue | None, queued: Queued | None) -> Status:
    """State of a directory by its job's own account; where the queue knows the job, the queue is right."""
    state, reason, number = told.get("state", ""), told.get("reason", ""), told.get("job", "")
    steps = number_of(told.get("steps"))
    step = number_of(told.get("step"))
    if state == "done":
        return Status(directory, "done", step, steps)
    here = queue is not None and queue.cluster == told.get("cluster")
    if queue is not None and here and queued is None:
        queued = queue.job(number)
    step = latest(step, last_step_of(directory))
    if queued is not None:
        if queued.waiting:
            return Status(directory, "waiting", step, steps, f"job {queued.number} is in the queue")
        return Status(directory, "running", step, steps, f"job {queued.number}" + (f", {reason}" if reason else ""))
    onwards = f"`sbatch {file_names.JOB}` there"
    if not (directory / file_names.JOB).is_file():
        onwards = f"`sbatch {file_names.JOB}` beside {file_names.CASES}"
    if state in ("waiting", "running") and here:
        why = f"job {number} is gone: killed, or its node lost; {onwards} {goes_on(directory)}"
        return Status(directory, "incomplete", step, steps, why)
    if state == "waiting":
        return Status(directory, "waiting", step, steps, f"job {number} {reason}, as it was told on {_when(told)}")
    if state == "running":
        if time.time() > (number_of(told.get("ends")) or 0) + GRACE:
            why = f"job {number} is past its time limit, so it was killed; {onwards} {goes_on(directory)}"
            return Status(directory, "incomplete", step, steps, why)
        return Status(directory, "running", step, steps, f"job {number}, as it was told on {_when(told)}")
    if state == "incomplete":
        return Status(directory, "incomplete", step, steps, f"{reason}; {onwards} {goes_on(directory)}")
    if state == "failed":
        return Status(directory, "failed", step, steps, f"{reason}; {onwards} tries again")
    return Status(directory, "failed", step, steps, f"{file_names.JOB_STATE} cannot be read; {onwards} tries again")


def _when(told: dict[str, str]) -> str:
    moment = time.localtime(number_of(told.get("time")) or 0)
    return time.strftime("%Y-%m-%d %H:%M", moment) + f" by {told.get('host') or 'its node'}"
