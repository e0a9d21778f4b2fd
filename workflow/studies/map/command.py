"""Map equipartition over coupling and number of chains, with the reference integrator."""

import argparse
import dataclasses

from workflow.screen import Answer, cell, count_bar, one_line, print_table
from workflow.studies.map import study as mapping
from workflow.studies.options import add_output, listed, within

ANSWERS = "the cases, as in map.csv"
DRAWS = True
EXAMPLES = (
    "map -o map                # some four minutes; the same command resumes",
    "map -o map --quiet",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to map, and where to."""
    couplings, chains = listed(float), listed(int)
    parser.add_argument(
        "--couplings",
        metavar="K,K,...",
        type=couplings,
        default=mapping.COUPLINGS,
        help="dimensionless couplings (default 1e-3 to 2)",
    )
    parser.add_argument(
        "--chains", metavar="N,N,...", type=chains, default=mapping.CHAINS, help="numbers of chains (default 2 to 8)"
    )
    parser.add_argument(
        "--most-beads", metavar="N", type=within(int, 60, 1e9), default=mapping.MOST_BEADS, help="longest chains"
    )
    add_output(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Run what is missing, print a table."""
    planned = mapping.plan(arguments.couplings, arguments.chains, arguments.most_beads)
    with count_bar("map") as progress:
        cases = mapping.make_map(planned, arguments.output, progress)
    print_table(
        "leading pulses: beads from which all chains agree to 10 and 1 %, mean and spread at the end (V = 1)",
        [field.name for field in dataclasses.fields(mapping.Case)],
        [[cell(value, ".4g") for value in vars(case).values()] for case in cases],
    )
    print(f"{one_line(arguments.output)}: {', '.join(mapping.STUDY.files)}")
    return Answer(0, [vars(case) for case in cases])
