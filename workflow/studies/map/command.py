"""Map equipartition over coupling and number of chains, with the reference integrator."""

import argparse

from workflow.screen import Answer, count_bar, one_line
from workflow.studies.map import study as mapping
from workflow.studies.options import add_output, listed, within
from workflow.studies.study import print_records

ANSWERS = "the cases, as in map.csv"
DRAWS = True
EXAMPLES = (
    "map -o map                # some four minutes; the same command resumes",
    "map -o map --quiet",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to map, and where to."""
    words = ("dimensionless couplings (default 1e-3 to 2)", "numbers of chains (default 2 to 8)", "longest chains")
    most = within(int, 60, 1e9)
    parser.add_argument("--couplings", metavar="K,...", type=listed(float), default=mapping.COUPLINGS, help=words[0])
    parser.add_argument("--chains", metavar="N,...", type=listed(int), default=mapping.CHAINS, help=words[1])
    parser.add_argument("--most-beads", metavar="N", type=most, default=mapping.MOST_BEADS, help=words[2])
    add_output(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Run what is missing, print a table."""
    planned = mapping.plan(arguments.couplings, arguments.chains, arguments.most_beads)
    with count_bar("map") as progress:
        cases = mapping.make_map(planned, arguments.output, progress)
    title = "leading pulses: bead from which all chains agree, and what is left at the end (V = 1)"
    print_records(title, mapping.Case, cases)
    print(f"{one_line(arguments.output)}: {', '.join(mapping.STUDY.files)}")
    return Answer(0, [vars(case) for case in cases])
