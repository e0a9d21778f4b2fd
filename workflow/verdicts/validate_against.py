"""Compare a run with what a user names: another run, a trajectory in a file, or measured traces in a file."""

import math
from pathlib import Path

from analysis.files import traces
from analysis.files.traces import TraceFile
from lammps_inputs import InputError
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate import Validation
from workflow.verdicts.validate_run import validate_run
from workflow.verdicts.validate_table import validate_table, validate_traces


def run_or_file(path: Path) -> RunDirectory | Path:
    """The run in a directory, or the path of anything else.

    Raises:
        InputError: a directory that is no run directory, or may not be looked into.
    """
    try:
        is_directory = path.is_dir()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    return RunDirectory(path) if is_directory else path


def validate_against(
    directory: RunDirectory,
    against: RunDirectory | TraceFile | Path,
    *,
    dimensionless: bool = False,
    tolerances: dict[str, float] | None = None,
    offset: float | None = None,
) -> Validation:
    """Compare a run with another run or a file; writes what `workflow.verdicts.validate.validate` writes.

    Args:
        directory: the run.
        against: another run of the same scene, or a file: a table (`analysis.files.table`) or traces
            (`analysis.files.traces`).
        dimensionless: whether a file is in units of V = 1; else it is in the scene's own units.
        tolerances: quantity -> largest difference let pass, in place of the one in `TOLERANCES`, dimensionless.
        offset: by how much the times of traces are later than the run's, in the file's units; 0 if None.

    Raises:
        InputError: the file cannot be read, or the two have no scene, bead or time in common.
    """
    if offset is not None and not math.isfinite(offset):
        raise InputError(f"--offset: {offset} given; a time in the units of FILE, such as 0")
    if isinstance(against, RunDirectory):
        if dimensionless:
            raise InputError("--units: is for a file; frames of runs have units of their own")
        refuse_offset(offset)
        return validate_run(directory, against, tolerances)
    if isinstance(against, TraceFile) or traces.are_in(against):
        return validate_traces(
            directory, against, dimensionless=dimensionless, tolerances=tolerances, offset=offset or 0.0
        )
    refuse_offset(offset)
    return validate_table(directory, against, dimensionless=dimensionless, tolerances=tolerances)


def refuse_offset(offset: float | None) -> None:
    """Refuse an offset of times where there are no traces.

    Raises:
        InputError: an offset is given.
    """
    if offset is not None:
        raise InputError("--offset: is for a file of traces, whose times may be later than the run's")
