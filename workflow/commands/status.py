"""Print the state of run directories: waiting, running, done, failed or incomplete, and why.

Exit code 1 if one has failed or holds no run, 2 if one does not exist.
"""

import argparse
import os
from collections import Counter
from pathlib import Path

from lammps_inputs import InputError
from workflow.runs.status import Status, cluster_queue, statuses
from workflow.screen import CommandResult, one_line

PRINTS = True
ANSWERS = "a list of objects"
EXAMPLES = (
    "status runs",
    "status demo job --json",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the directories."""
    parser.add_argument(
        "directories", metavar="DIR", type=Path, nargs="+", help="run directories, or one with a list of cases"
    )
    parser.description = f"{parser.description} Exit code 1 if one has failed or holds no run, 2 if one does not exist."


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print a line per directory; exit code 1 if one has failed or holds no run.

    Raises:
        InputError: one does not exist.
    """
    for path in arguments.directories:
        if not os.path.lexists(path):
            raise InputError(f"{one_line(path)}: no such directory")
    states = statuses(arguments.directories, cluster_queue())
    for status in states:
        print(line(status))
    if len(states) > 1:
        counts = Counter(status.state for status in states)
        print(f"{len(states)} directories: {', '.join(f'{count} {state}' for state, count in counts.items())}")
    return CommandResult(
        int(any(status.state in ("failed", "none") for status in states)), [status.plain() for status in states]
    )


def line(status: Status) -> str:
    """State of a directory in one line."""
    far = ""
    if status.step is not None and status.steps and status.state not in ("none", "written"):
        far = f" at step {status.step} of {status.steps}"
        if status.state == "done":
            far = f", {status.steps} steps"
    name = "".join(sign if sign.isprintable() else "?" for sign in str(status.directory))
    return f"{name}: {status.state}{far}" + (f": {status.why}" if status.why else "")
