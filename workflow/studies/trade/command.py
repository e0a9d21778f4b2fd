"""Measure error against cost on this machine: time steps, schemes, ranks, windows, frames."""

import argparse
import math
import sys
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.runs.engines import REFERENCE
from workflow.screen import count_bar, one_line
from workflow.studies.study import print_records
from workflow.studies.trade import study
from workflow.studies.trade.advice import sentences
from workflow.studies.trade.points import Findings, Order
from workflow.studies.trade.truth import Interval

DRAWS = True
EXAMPLES = (
    "trade two-chains -o trade",
    "trade my/scene.yaml -o trade --budget 120   # seconds",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, where to, and how long it may take."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory to make")
    parser.add_argument(
        "--budget",
        metavar="SECONDS",
        type=float,
        default=study.BUDGET,
        help=f"about how long it may take; runs that would take much of it are left out (default {study.BUDGET:g})",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print tables and sentences; write two tables, a report and a figure."""
    if not (math.isfinite(arguments.budget) and arguments.budget > 0.0):
        raise InputError(f"--budget: {arguments.budget:g} given; a number of seconds above 0")
    problem = study.plain_problem(library.find(arguments.scene))
    seconds = REFERENCE.seconds(problem, 1) or 0.0
    if seconds > arguments.budget:
        print(
            f"granchain: a large scene: the reference alone takes some {seconds:.0f} s; a shorter duration or fewer "
            "beads show the same trade",
            file=sys.stderr,
        )
    with count_bar("trade") as progress:
        found = study.study(problem, arguments.output, budget=arguments.budget, follow=progress)
    _print(found)
    names = [name for name in study.STUDY.files if (arguments.output / name).exists()]
    print(f"{one_line(arguments.output)}: {', '.join(names)}")
    if not found.whole:
        raise KeyboardInterrupt
    return 0


def _print(found: Findings) -> None:
    scale = found.problem.scale
    title = (
        f"{found.problem.name}: largest errors (V, V, T), wall time (s) of the time loop with its frames; steps in T"
    )
    tables = (
        (title, study.Record, study.records(found)),
        ("measured orders, of velocities", Order, found.orders()),
        ("errors of amplitudes (V) and arrivals (T), by the time between frames", Interval, found.frames),
    )
    for title, kind, records in tables:
        if records:
            print_records(title, kind, records, scale)
    for sentence in sentences(found):
        print(sentence)
