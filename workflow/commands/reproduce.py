"""Compute the statements and figures of the paper: the gallery with the entries of the paper only."""

import argparse

from workflow.screen import Answer
from workflow.studies.gallery.entries import PAPER
from workflow.studies.gallery.study import ANSWERS, run_entries
from workflow.studies.options import add_output

__all__ = ["ANSWERS"]

EXAMPLES = (
    "reproduce -o paper      # some ten seconds; then open paper/index.html",
    "reproduce -o paper -q   # print nothing but errors",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to."""
    add_output(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Run what is missing, write the page, print the verdicts."""
    return run_entries(arguments.output, PAPER)
