"""Run scenes at the extremes of every number and check that errors are reported."""

import argparse
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.screen import count_bar, one_line
from workflow.studies.extremes import cells, study
from workflow.studies.extremes.measure import KINDS, Outcome
from workflow.studies.study import print_records

EXAMPLES = (
    "extremes --quick",
    "extremes losses loads",
    "extremes -o extremes      # the same command resumes",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to, and how much."""
    parser.add_argument("parts", metavar="PART", nargs="*", help=f"of {', '.join(cells.PARTS)} (default all)")
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help="new directory, or one to resume: table, cells"
    )
    parser.add_argument("--quick", action="store_true", help="only the cells that take about a second")


def execute(arguments: argparse.Namespace) -> int:
    """Run what is missing, print a table; exit code 1 if a cell is silently wrong."""
    for name in arguments.parts:
        if name not in cells.PARTS:
            known = library.suggestion(name[:60], cells.PARTS)
            raise InputError(f"extremes: {name[:60]!r} given{known}; of {', '.join(cells.PARTS)}")
    chosen = cells.grid(arguments.parts)
    if arguments.quick:
        chosen = [cell for cell in chosen if study.cost(cell) <= study.QUICK]
    with count_bar("extremes") as progress:
        outcomes = study.make_report(chosen, arguments.output, progress=progress)
    title = "largest error of any velocity (V), against a more accurate reference"
    print_records(title, Outcome, outcomes)
    for outcome in outcomes:
        if outcome.kind in ("REFUSED", "STOPPED", "WRONG"):
            print(f"{outcome.kind} {outcome.axis} {outcome.value}: {outcome.why}")
    counts = {kind: sum(outcome.kind == kind for outcome in outcomes) for kind in KINDS}
    print(f"{len(outcomes)} cells: " + ", ".join(f"{number} {kind}" for kind, number in counts.items()))
    if arguments.output is not None:
        print(f"{one_line(arguments.output)}: {', '.join(study.STUDY.files)}")
    return 1 if counts["WRONG"] else 0
