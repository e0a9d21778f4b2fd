"""LAMMPS in this process, one instance after another, for a process whose only work is to run scenes.

What starts a process for every run (`engine`) pays for a fresh interpreter each time; an instance costs a millisecond.
In return an abort of LAMMPS takes this process along: whoever started it must see that and report it.
"""

import os
from pathlib import Path

from lammps_inputs import Problem
from workflow.engines.lammps import worker
from workflow.engines.lammps.engine import RESTART_EVERY, LammpsOutcome, Progress
from workflow.errors import RunError, first_line


class LammpsError(RunError):
    """LAMMPS itself failed: no instance in this process can be trusted any more, not even to close."""


def run(
    directory: Path,
    *,
    problem: Problem,
    ranks: int = 1,
    progress: Progress | None = None,
    part: int = 1,
    restart_every: float = RESTART_EVERY,
    lock: int | None = None,  # noqa: ARG001  this process holds it itself
) -> LammpsOutcome:
    """Run the deck of a directory on one rank; ends early, with a restart, when standard input closes.

    Changes the working directory, since LAMMPS opens its files there. Arguments as of `engine.run`.

    Raises:
        LammpsError: LAMMPS failed; this process should end.
        RunError: a state of the run is none that there can be, or the disk is full.
    """
    assert ranks == 1
    os.chdir(directory)

    def tell(line: worker.Line) -> None:
        if progress is not None:
            progress(line["step"], line["bead"])

    try:
        instance = worker.instance(part)
        end = worker.segments(instance, problem, tell, part=part, every=restart_every)
    except Exception as error:  # LAMMPS raises nothing more specific
        raise LammpsError(f"LAMMPS: {first_line(error)}") from None
    instance.close()
    if end["end"] == "failed":
        raise RunError(end["reason"])
    return LammpsOutcome(end["end"], end["step"], end["seconds"], end["lammps"])
