"""The option ``--page`` of `granchain validate`: an interactive page of the differences."""

import argparse
import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from granchain import InputError
from granchain.parts import RunDirectory, validate
from workflow.plugins.pages import need_bokeh

EXAMPLES = ("validate demo --page            # writes demo/validation.html, too",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the option."""
    parser.add_argument(
        "--page",
        action="store_true",
        help="write validation.html (validation-against.html), too: an interactive page of the differences from the "
        "reference (from another run)",
    )


def execute(arguments: argparse.Namespace, command: Callable[[argparse.Namespace], Any]) -> Any:
    """Validate, and write the page where it is asked for."""
    if arguments.page:
        need_bokeh()
        _refuse_file(arguments.against)
        arguments.write_beside = _write_page
    return command(arguments)


def _refuse_file(against: Path | None) -> None:
    """Refuse a trajectory in a file.

    Raises:
        InputError: the run is to be compared with a file.
    """
    is_file = False
    with contextlib.suppress(OSError):  # which the command reports
        is_file = against is not None and against.is_file()
    if is_file:
        raise InputError(f"--page: shows two runs, or a run and the reference, and {against} is a file; leave it out")


def _write_page(directory: RunDirectory, comparison: validate.Validation, against: RunDirectory | None) -> str:
    """Write the page of a validation into the directory of its run; the name of its file."""
    from workflow.plugins.pages.write import write_validation  # bokeh takes half a second to import

    return write_validation(directory, comparison, against).name
