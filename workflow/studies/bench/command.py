"""Measure the speed of granchain's components against alternative implementations."""

import argparse

from lammps_inputs import InputError, library
from workflow.errors import RunError
from workflow.screen import print_table
from workflow.studies.bench.study import PARTS, measure

EXAMPLES = (
    "bench",
    "bench window reader",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which parts."""
    parser.add_argument("parts", metavar="PART", nargs="*", help="such as window, reader (default all)")


def execute(arguments: argparse.Namespace) -> int:
    """Print a table of ratios, also where a part failed; exit code 1 if one failed or a ratio misses its goal."""
    for name in arguments.parts:
        if name not in PARTS:
            raise InputError(f"bench: {name!r} given{library.suggestion(name, PARTS)}; of {', '.join(PARTS)}")
    rows, missed, failed = [], 0, []
    try:
        for name in arguments.parts or PARTS:
            try:
                for ratio in measure(name):
                    print(f"{ratio.name}: {ratio.value:.3g}", flush=True)
                    missed += not ratio.reached
                    verdict = "" if ratio.reached else "MISSED"
                    rows.append([ratio.name, f"{ratio.value:.3g}", ratio.goal, verdict, ratio.detail])
            except Exception as error:  # whatever it is, the other parts are measured
                failed.append(f"{name} ({type(error).__name__}: {error})")
    finally:
        if rows:
            print()
            head = ["what", "found", "goal", "", "first, second, spread"]
            print_table("measured side by side, medians", head, rows)
    if failed:
        raise RunError(f"bench: failed: {', '.join(failed)}")
    return 1 if missed else 0
