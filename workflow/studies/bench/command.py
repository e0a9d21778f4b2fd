"""Measure the speed of granchain's components against alternative implementations."""

import argparse

from lammps_inputs import InputError, library
from workflow.errors import RunError
from workflow.studies.bench.study import PARTS, Ratio, measure
from workflow.studies.study import print_records

EXAMPLES = (
    "bench",
    "bench window reader",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which parts."""
    parser.add_argument("parts", metavar="PART", nargs="*", help=f"of {', '.join(PARTS)} (default all)")


def execute(arguments: argparse.Namespace) -> int:
    """Print a table of ratios, also where a part failed; exit code 1 if one failed or a ratio misses its goal."""
    for name in arguments.parts:
        if name not in PARTS:
            raise InputError(f"bench: {name!r} given{library.suggestion(name, PARTS)}; of {', '.join(PARTS)}")
    ratios: list[Ratio] = []
    failed = []
    try:
        for name in arguments.parts or PARTS:
            try:
                for ratio in measure(name):
                    print(f"{ratio.name}: {ratio.value:.3g}", flush=True)
                    ratios.append(ratio)
            except Exception as error:  # whatever it is, the other parts are measured
                failed.append(f"{name} ({type(error).__name__}: {error})")
    finally:
        if ratios:
            print()
            print_records("measured side by side, medians", Ratio, ratios)
    if failed:
        raise RunError(f"bench: failed: {', '.join(failed)}")
    return 1 if any(ratio.verdict for ratio in ratios) else 0
