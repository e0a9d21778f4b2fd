"""Table of the quantities of single runs, as that of a sweep has them."""

import contextlib
from collections.abc import Sequence

from lammps_inputs import InputError
from workflow.runs.run_directory import RunDirectory
from workflow.sweep.cases import is_analysed, read_json
from workflow.sweep.collect import SweepTable, quantities
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.analysis_report import REPORT


def table_of(runs: Sequence[RunDirectory]) -> SweepTable:
    """Table of the quantities of some runs in the units of the first; those that were not analysed are analysed first.

    A run that cannot be analysed has only what it recorded.

    Args:
        runs: run directories, one at least.

    Returns:
        The table, [run], with the name of each directory as its case.

    Examples:
        >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
        >>> table = table_of([granchain.run(scene, tmp / "run", engine="reference").directory])
        >>> table.numbers("peak_velocity").round(3)
        array([0.682])
    """
    rows = []
    for run in runs:
        if not is_analysed(run.path):
            with contextlib.suppress(InputError):
                analyse(run, figures=False)
        report = read_json(run.path / REPORT) if is_analysed(run.path) else {}
        measured = quantities(report, run.account.plain(), run.scene.plain())
        rows.append({"case": run.path.name, "outcome": None, **measured, "reason": None})
    return SweepTable([], rows, si=runs[0].problem.scale.si)
