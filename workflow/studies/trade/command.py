"""Measure error against cost on this machine: time steps, schemes, ranks, windows, frames."""

import argparse
import math
import sys
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.formats import figure_files
from workflow.screen import count_bar, one_line, print_table
from workflow.studies.trade import study
from workflow.studies.trade.advice import sentences
from workflow.studies.trade.study import Findings

LARGE = 1e9
"""Bytes of frames above which a scene is said to be large."""


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
    parser.add_argument(
        "--repeats",
        metavar="N",
        type=int,
        default=study.REPEATS,
        help=f"timed runs of each setting after its first (default {study.REPEATS})",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print tables and sentences; write two tables, a report and a figure."""
    if not (math.isfinite(arguments.budget) and arguments.budget > 0.0):
        raise InputError(f"--budget: {arguments.budget:g} given; a number of seconds above 0")
    if arguments.repeats < 0:
        raise InputError(f"--repeats: {arguments.repeats} given; 0 or more")
    problem = study.plain_problem(library.find(arguments.scene))
    seconds, size = study.expected(problem)
    if seconds > arguments.budget or size > LARGE:
        print(
            f"granchain: a large scene: the reference alone takes some {seconds:.0f} s, and frames "
            f"{2 * size / 1e9:.2g} GB in DIR while it runs; a shorter duration or fewer beads show the same trade",
            file=sys.stderr,
        )
    with count_bar("trade") as progress:
        found = study.study(
            problem,
            arguments.output,
            budget=arguments.budget,
            repeats=arguments.repeats,
            follow=progress,
        )
    advice = sentences(found)
    _print(found, advice)
    study.write(found, arguments.output, advice)
    names = [study.ENGINES, study.FRAMES, study.REPORT, *figure_files(study.FIGURE)]
    print(f"{one_line(arguments.output)}: {', '.join(name for name in names if (arguments.output / name).exists())}")
    if not found.whole:
        raise KeyboardInterrupt
    return 0


def _print(found: Findings, sentences: list[str]) -> None:
    if found.truth is None:
        return
    front, floor = {id(point) for point in found.front("velocity")}, study.WELL_ABOVE * found.truth.floors["velocity"]
    rows = [
        [
            point.setting.curve,
            point.setting.label,
            f"{'~' if point.errors['velocity'] < floor else ''}{point.errors['velocity']:.1e}",
            f"{point.errors['amplitude']:.1e}",
            f"{point.errors['arrival']:.1e}",
            "" if math.isnan(point.cost("forces")) else f"{point.cost('forces'):.3g}",
            f"{point.cost('seconds'):.3g}",
            f"{min(point.costs('seconds')):.2g}-{max(point.costs('seconds')):.2g}",
            f"{point.first['start'] + point.first['seconds']:.2g}",
            "*" if id(point) in front else "",
        ]
        for point in found.engines
        if point.measured
    ]
    print_table(
        f"{found.problem.name}: largest errors (V, V, T), and wall time of the time loop with its frames; steps in T",
        ["method", "at", "velocity", "amplitude", "arrival", "forces", "s", "spread", "first", "front"],
        rows,
    )
    orders = [(name, order) for name, by in found.orders().items() if (order := by["velocity"]) is not None]
    if orders:
        print_table(
            "measured orders, of velocities",
            ["method", "order", "+-", "over steps", "points"],
            [
                [
                    name,
                    f"{order.value:.2f}",
                    "" if math.isnan(order.spread) else f"{order.spread:.2f}",
                    f"{order.low:.4g} - {order.high:.4g}",
                    str(order.points),
                ]
                for name, order in orders
            ],
        )
    if found.frames:
        rows = [
            [f"{one.every:.4g}", f"{one.amplitude_error:.1e}", f"{one.arrival_error:.1e}", f"{one.bytes / 1e6:.3g}"]
            for one in found.frames
        ]
        print_table(
            "errors of reading one LAMMPS run, by the time between frames (T)",
            ["every", "amplitude", "arrival", "MB"],
            rows,
        )
    for sentence in sentences:
        print(sentence)
