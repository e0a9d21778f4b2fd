"""Measure error against cost on this machine: time steps, schemes, ranks, windows, frames."""

import argparse
import math
import sys
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.screen import count_bar, one_line, print_table
from workflow.studies.trade import advice, report, study
from workflow.studies.trade import study as studying
from workflow.studies.trade.study import Findings
from workflow.studies.trade.work_precision import pareto

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
        default=studying.BUDGET,
        help=f"about how long it may take; runs that would take much of it are left out (default {studying.BUDGET:g})",
    )
    parser.add_argument(
        "--repeats",
        metavar="N",
        type=int,
        default=studying.REPEATS,
        help=f"timed runs of each setting after its first (default {studying.REPEATS})",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print tables and sentences; write two tables, a report and a figure."""
    if not (math.isfinite(arguments.budget) and arguments.budget > 0.0):
        raise InputError(f"--budget: {arguments.budget:g} given; a number of seconds above 0")
    if arguments.repeats < 0:
        raise InputError(f"--repeats: {arguments.repeats} given; 0 or more")
    problem = studying.plain_problem(library.find(arguments.scene))
    seconds, size = studying.expected(problem)
    if seconds > arguments.budget or size > LARGE:
        print(
            f"granchain: a large scene: the reference alone takes some {seconds:.0f} s, and frames "
            f"{2 * size / 1e9:.2g} GB in DIR while it runs; a shorter duration or fewer beads show the same trade",
            file=sys.stderr,
        )
    with count_bar("trade") as progress:
        found = studying.study(
            problem,
            arguments.output,
            budget=arguments.budget,
            repeats=arguments.repeats,
            follow=lambda _, done, total: progress(done, total),
        )
    _print(found)
    written = [name for name in (study.ENGINES, study.FRAMES) if (arguments.output / name).exists()]
    print(f"{one_line(arguments.output)}: {', '.join(written + report.write(found, arguments.output))}")
    if not found.whole:
        raise KeyboardInterrupt
    return 0


def _print(found: Findings) -> None:
    truth = found.truth
    if truth is None:
        return
    front = {id(point) for point in pareto(advice.comparable(found.engines), "velocity", "seconds")}
    rows = []
    for point in found.engines:
        if not point.measured:
            continue
        seconds, unsure = point.costs("seconds"), advice.WELL_ABOVE * truth.floors["velocity"]
        rows.append(
            [
                point.setting.curve,
                point.setting.label,
                f"{'~' if point.errors['velocity'] < unsure else ''}{_error(point.errors['velocity'])}",
                _error(point.errors["amplitude"]),
                _error(point.errors["arrival"]),
                "" if math.isnan(point.cost("forces")) else f"{point.cost('forces'):.3g}",
                f"{point.cost('seconds'):.3g}",
                f"{min(seconds):.2g}-{max(seconds):.2g}",
                f"{point.first['start'] + point.first['seconds']:.2g}",
                "*" if id(point) in front else "",
            ]
        )
    head = ["method", "at", "velocity", "amplitude", "arrival", "forces", "s", "spread", "first", "front"]
    print_table(
        f"{found.problem.name}: largest errors (V, V, T), and wall time of the time loop with its frames; steps in T",
        head,
        rows,
    )
    _print_orders(found)
    _print_frames(found)
    for sentence in advice.sentences(found):
        print(sentence)


def _print_orders(found: Findings) -> None:
    assert found.truth is not None
    rows = []
    for name, by in report.orders(found, found.truth).items():
        order = by["velocity"]
        if order is not None:
            spread = "" if math.isnan(order.spread) else f"{order.spread:.2f}"
            rows.append([name, f"{order.value:.2f}", spread, f"{order.low:.4g} - {order.high:.4g}", str(order.points)])
    if rows:
        print_table("measured orders, of velocities", ["method", "order", "+-", "over steps", "points"], rows)


def _print_frames(found: Findings) -> None:
    rows = [
        [
            point.setting.curve,
            point.setting.label,
            *(_error(point.errors[name]) for name in ("velocity", "amplitude", "arrival")),
            f"{point.cost('run'):.3g}",
            f"{point.cost('read'):.3g}",
            f"{point.cost('bytes') / 1e6:.3g}",
        ]
        for point in found.frames
        if point.measured
    ]
    if rows:
        head = ["recorded", "as", "velocity", "amplitude", "arrival", "run (s)", "read (s)", "MB"]
        print_table("what is lost in the frames of one LAMMPS run, at the scene's time step", head, rows)


def _error(value: float) -> str:
    return f"{value:.1e}"
