"""A Slurm job that runs one command on the cores of one node, and submits itself until that has come to its end.

The command is to end with exit code 130 when it is asked to stop, keeping what it has done, and to go on when it is
started again. What it prints is in ``job.out``.
"""

import importlib.resources
import shlex
from collections.abc import Sequence
from pathlib import Path

from lammps_inputs import file_names
from lammps_inputs.errors import InputError
from lammps_inputs.slurm.job import head
from lammps_inputs.slurm.site import JobOptions


def render_command(options: JobOptions, name: str, words: Sequence[str], *, cores: int, jobs: int | None = None) -> str:
    """The text of ``job.sbatch``, to be submitted in the directory that the command works in.

    Args:
        options: what the job asks for; one node.
        name: of the job.
        words: of the command.
        cores: that it uses.
        jobs: at most, each submitted by the one before; by default as the options say.

    Raises:
        InputError: more than one node is asked for.
    """
    if options.nodes != 1:
        raise InputError(f"--nodes: {options.nodes} given; this command works on the cores of one node")
    asked = {"ntasks": 1, "cpus-per-task": cores, "signal": f"B:TERM@{options.stop_before}"}
    lines = [
        *head(options, name, asked),
        f"# In this directory: sbatch {file_names.JOB}    What it says: {file_names.JOB_OUTPUT}",
        f"max_jobs={options.max_jobs if jobs is None else jobs}",
        f"command=({shlex.join(words)})",
        f"modules=({shlex.join(options.modules)})",
        "",
    ]
    body = Path(str(importlib.resources.files("lammps_inputs.slurm") / "command.sh")).read_text(encoding="utf-8")
    return "\n".join(lines) + "\n" + body
