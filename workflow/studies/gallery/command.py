"""Compute published results on granular chains and compare them with the publications, as an HTML page."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from workflow.screen import Answer, count_bar, one_line, print_table
from workflow.studies.gallery.entries import ENTRIES
from workflow.studies.gallery.study import PAGE, gallery
from workflow.studies.page import VERDICTS

EXAMPLES = (
    "gallery -o gallery                # half a minute; the same command resumes; then open gallery/index.html",
    "gallery -o gallery --only dimers  # recompute this one; the others remain",
    "gallery --list",
)

ANSWERS = "each entry with its title, its verdicts, and why it failed"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where to, and what."""
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("-o", "--output", metavar="DIR", type=Path, help="new directory, or one to resume")
    where.add_argument("--list", action="store_true", help="print the names of the entries, and run nothing")
    parser.add_argument(
        "--only", metavar="NAME", action="append", default=[], help="run this entry only; may be given several times"
    )


def execute(arguments: argparse.Namespace) -> Answer:
    """Print the names, or run what is missing."""
    if arguments.list:
        print("\n".join(ENTRIES))
        return Answer(0, list(ENTRIES))
    return run_entries(arguments.output, arguments.only)


def run_entries(directory: Path, names: Sequence[str]) -> Answer:
    """Run entries (all by default), write the page, print the verdicts; exit code 1 if one could not be run."""
    with count_bar("gallery") as progress:
        found = gallery(directory, names, progress=progress)
    rows, plain = [], []
    for name, section in found.items():
        counts = section.verdicts
        rows.append([name, *(str(count or "-") for count in counts.values()), "failed" if section.failed else ""])
        plain.append({"name": name, "title": section.title, **counts, "failed": section.failed or None})
    print_table("statements", ["entry", *VERDICTS, ""], rows)
    for name, section in found.items():
        if section.failed:
            print(f"{name}: failed: {one_line(section.failed)}")
    print(one_line(directory / PAGE))
    return Answer(int(any(section.failed for section in found.values())), plain)
