"""Compute the paper's figures and statements, as an HTML page."""

import argparse
from pathlib import Path

from workflow.errors import RunError
from workflow.screen import count_bar, one_line
from workflow.studies.gallery.study import PAGE, PAPER, gallery

EXAMPLES = (
    "reproduce -o paper        # then open paper/index.html",
    "reproduce -o paper --quiet",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to."""
    parser.add_argument(
        "-o", "--output", metavar="DIR", type=Path, required=True, help="new directory, or one to resume"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Run what is missing, write the page and its figures."""
    with count_bar("reproduce") as progress:
        found = gallery(arguments.output, collection=PAPER, progress=progress)
    print(one_line(arguments.output / PAGE))
    for name, section in found.items():
        if section.failed:
            raise RunError(f"{name}: {section.failed}")
    return 0
