"""Compute the paper's figures and statements from scratch, as one HTML page."""

import argparse
import sys
from pathlib import Path

from workflow.screen import one_line
from workflow.studies.reproduce.report import reproduce

EXAMPLES = (
    "reproduce -o paper        # then open paper/index.html",
    "reproduce -o paper --quiet",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to."""
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="made, or gone on with")


def execute(arguments: argparse.Namespace) -> int:
    """Run what is missing, write the page and its figures."""
    path = reproduce(arguments.output, lambda line: print(line, file=sys.stderr, flush=True))
    print(one_line(path))
    return 0
