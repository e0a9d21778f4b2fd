"""Compute one case of a sweep: what a worker process does in the case's directory."""

import contextlib
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, file_names, library
from workflow.engines.lammps import hosted
from workflow.formats import written_as
from workflow.runs.files import RECORD
from workflow.runs.resume import resume
from workflow.runs.run import Run, run
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.directory import Asked, begin
from workflow.verdicts.analyse import analyse
from workflow.workers.pool import Task


def task(directory: Path, case: Asked | None, *, check: bool, figures: tuple[str, ...] = ()) -> Task:
    """For the worker pool.

    Args:
        directory: of the case, an absolute path.
        case: what to run first; None to analyse only what is there.
        check: whether to measure the error of a LAMMPS run.
        figures: formats of the figures to draw; none without any.
    """
    plain = None if case is None else case.plain()
    return Task(
        f"{__name__}:compute", {"directory": str(directory), "case": plain, "check": check, "figures": list(figures)}
    )


def compute(directory: str, case: dict[str, Any] | None, check: bool, figures: list[str]) -> str:
    """Run and analyse a case; "done" or "stopped"."""
    path = Path(directory)
    if case is not None:
        done = _run(path, Asked(**case), check=check)
        if done.outcome != "done":
            return "stopped"
        analysed = done.directory  # with the frames that were read for the check
    else:
        if check and (path / RECORD).is_file():
            resume(path)  # it is done, but perhaps its error was not measured any more
        analysed = RunDirectory(path)
    with written_as(tuple(figures)):
        analyse(analysed, figures=bool(figures))
    return "done"


def _run(directory: Path, case: Asked, *, check: bool) -> Run:
    """From the last restart if there is one; most cases take less time than passes until one is written."""
    if (directory / file_names.RESTART).is_file():
        with contextlib.suppress(InputError):  # not one to resume from
            resumed = resume(directory, check=check, lammps=hosted.run)
            if resumed is not None:
                return resumed
    scene = library.from_plain(case.scene, str(directory))
    begin(directory, case, scene)
    return run(scene, directory, engine=case.engine, overwrite=True, check=check, lammps=hosted.run)
