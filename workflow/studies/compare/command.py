"""Run a scene with several engines and compare the results, such as rigid and Hertzian beads."""

import argparse

from lammps_inputs import library, physics
from workflow.formats import figure_files
from workflow.prepare.settings import refuse_unstable
from workflow.runs.engines import ENGINES
from workflow.screen import Answer, count_bar, one_line, print_table
from workflow.studies.compare.study import FIGURE, REPORT, compare, engines_for
from workflow.studies.options import add_output

ANSWERS = "what compare.json holds"
DRAWS = True
EXAMPLES = (
    "compare two-chains-gapped -o compared",
    "compare my/gapped.yaml -o compared --engines collisions,reference",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The scene, where to, and with what."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    add_output(parser)
    parser.add_argument(
        "--engines", metavar="NAME,NAME", help=f"of {', '.join(ENGINES)} (default all that can do the scene)"
    )


def execute(arguments: argparse.Namespace) -> Answer:
    """Print tables and an answer; write compare.json, a figure, and each engine's run directory."""
    scene = library.find(arguments.scene)
    engines = None if arguments.engines is None else tuple(arguments.engines.split(","))
    if "lammps" in engines_for(scene, engines):
        refuse_unstable(scene, arguments.scene)
    with count_bar("compare") as progress:
        found = compare(scene, arguments.output, engines, progress)
    system = found.problem.system
    if physics.gap(system) and physics.coupled(system):
        from workflow.engines.collisions import modes  # numba takes a third of a second to import

        print(f"theta = omega D / V = {modes.theta(found.problem):.5g} (eq. 5: {modes.THETA_OF_EQ_5:.5g})")
    for table in found.tables():
        print_table(*table)
    for sentence in found.answer:
        print(sentence)
    files = [REPORT, *figure_files(FIGURE), *(f"{result.engine}/" for result in found.results)]
    print(f"{one_line(arguments.output)}: {', '.join(files)}")
    return Answer(0, found.plain())
