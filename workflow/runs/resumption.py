"""How an incomplete run is completed, in words."""

import shlex
from pathlib import Path

from lammps_inputs import file_names
from workflow.engines.lammps.files_on_disk import step_of
from workflow.runs.job import Job, restart_refused


def onwards(directory: Path, job: Job) -> str:
    """How to complete a local run that is incomplete."""
    return f"`granchain run --resume {shlex.quote(str(directory))}` {goes_on_from(directory, job)}"


def goes_on_from(directory: Path, job: Job | None = None) -> str:
    """The step from which an incomplete run resumes; a local one by its account."""
    step = step_of(directory / file_names.RESTART)
    if not step:
        return "starts again, as there is no restart"
    if job is not None and job.engine == "lammps" and (why := restart_refused(job)):
        return f"starts again, for {why}"
    return f"resumes at step {step}"
