"""Run a scene with several engines and compare the results, such as rigid and Hertzian beads."""

import argparse
import tempfile
from pathlib import Path

from analysis.trajectory import Floats
from lammps_inputs import library, physics
from workflow.formats import figure_files
from workflow.prepare.settings import refuse_unstable
from workflow.runs.engines import ENGINES
from workflow.screen import count_bar, one_line, print_table
from workflow.studies.compare.study import FIGURE, REPORT, Comparison, Result, arrival, compare, engines_for

DRAWS = True
EXAMPLES = (
    "compare two-chains-gapped -o compared",
    "compare my/gapped.yaml -o compared",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, where to, and with what."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help="new directory, or one to resume; default none"
    )
    parser.add_argument(
        "--engines",
        metavar="NAME,NAME",
        help=f"of {', '.join(ENGINES)} (default all that can do the scene)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print tables and an answer; write compare.json, a figure, and each engine's run directory."""
    scene = library.find(arguments.scene)
    engines = None if arguments.engines is None else tuple(arguments.engines.split(","))
    if "lammps" in engines_for(scene, engines):
        refuse_unstable(scene, arguments.scene)
    with tempfile.TemporaryDirectory(prefix="granchain-compare-") as name:
        directory = Path(name) / "compare" if arguments.output is None else arguments.output
        with count_bar("compare") as progress:
            found = compare(scene, directory, engines, progress)
    _print(found)
    if arguments.output is not None:
        names = [REPORT, *figure_files(FIGURE)]
        print(
            f"{one_line(arguments.output)}: {', '.join([*names, *(f'{result.engine}/' for result in found.results)])}"
        )
    return 0


def _print(found: Comparison) -> None:
    problem, results = found.problem, found.results
    scale = problem.scale
    if physics.gap(problem.system) and physics.coupled(problem.system):
        from workflow.engines.collisions import modes  # numba takes a third of a second to import

        print(f"theta = omega D / V = {modes.theta(problem):.5g} (eq. 5: {modes.THETA_OF_EQ_5:.5g})")
    rows = []
    for k, bead in enumerate(found.rows):
        for number, result in enumerate(results):
            impulses = result.impulses
            place = impulses.row(bead)
            if not (impulses.whole[:, place] > 0.0).any():
                rows.append([str(bead) if number == 0 else "", result.engine, "no impulse", "", "", ""])
                continue
            rows.append(
                [
                    str(bead) if number == 0 else "",
                    result.engine,
                    f"{arrival(impulses, bead) * scale.time:.6g}",
                    _list(impulses.first[:, place]),
                    _list(impulses.whole[:, place]),
                    _list(result.peak[:, k]),
                ]
            )
    first = scale.heading("first impulse at", "time")
    head = ["bead", "engine", first, "first impulse / mV", "all impulses / mV", "peak velocity / V"]
    print_table(f"{problem.name}: rows, chains 1, 2, ...", head, rows)
    shares = [
        [
            result.engine,
            _passed(result, found.last),
            _list(result.energy[:-1]),
            f"{result.energy[-1]:.4f}",
            f"{result.seconds:.2g}",
            f"{result.wall:.2g}",
        ]
        for result in results
    ]
    head = [
        "engine",
        f"passed to bead {found.last} by chain / mV",
        "final energy by chain",
        "in springs",
        "computing (s)",
        "with files (s)",
    ]
    print_table(f"shares until t = {scale.written(problem.duration, 'time')}", head, shares)
    for sentence in found.answer:
        print(sentence)


def _passed(result: Result, bead: int) -> str:
    return _list(result.impulses.whole[:, result.impulses.row(bead)]) if bead >= 2 else ""


def _list(values: Floats) -> str:
    shown = "  ".join(f"{value:.4f}" for value in values[:4])
    return f"{shown} ..." if len(values) > 4 else shown
