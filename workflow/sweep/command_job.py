"""A command of ours as a Slurm job on one node: `granchain ... --slurm` writes it in place of doing the work."""

import sys
from collections.abc import Sequence
from pathlib import Path

from lammps_inputs import file_names
from lammps_inputs.slurm.job import render_command
from lammps_inputs.slurm.site import JobOptions
from workflow.runs.files import write_text
from workflow.runs.own_files import claim, make_directory
from workflow.screen import Answer


def as_job(
    options: JobOptions, directory: Path, words: Sequence[str], *, cores: int, jobs: int | None = None
) -> Answer:
    """Write ``job.sbatch`` into a directory, which is made if need be, and say what to do with it.

    Args:
        options: of the job.
        directory: to be submitted in; the command is to name it as ``.``.
        words: of the command, after ``granchain``; paths in them absolute.
        cores: that it uses.
        jobs: as of `render_command`.

    Raises:
        InputError: the directory cannot be written, or holds such a file of somebody else's.
    """
    # -P: the directory it works in is no place for modules
    command = [sys.executable, "-P", "-m", "workflow", *words]
    text = render_command(options, f"granchain-{words[0]}", command, cores=cores, jobs=jobs, directory=directory)
    make_directory(directory)
    claim(directory, (file_names.JOB, file_names.JOB_OUTPUT))
    write_text(directory / file_names.JOB, text)
    print(f"{directory}: submit there: sbatch {file_names.JOB}; output: {file_names.JOB_OUTPUT}")
    return Answer(0, {"job": str(directory / file_names.JOB)})
