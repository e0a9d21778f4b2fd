"""Run a scene for lists or ranges of any of its fields, locally or as one array of jobs on a cluster."""

import argparse
import textwrap
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

from lammps_inputs import InputError, Scene
from workflow.engines.lammps.mpi import cores
from workflow.screen import CommandResult, one_line
from workflow.study_kit.options import add_output, example_file
from workflow.sweep import file, run_sweep
from workflow.sweep.case_decks import CaseDecks, planned_decks

ANSWERS = "how many cases there are, are done, have failed"
DRAWS = True
FILE = f"SWEEP.yaml:\n{textwrap.indent(example_file(file), '  ')}"
EXAMPLES = ("sweep sweep.yaml -o swept",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the sweep, the directory, and how to run."""
    parser.add_argument("sweep", metavar="SWEEP.yaml", type=Path, help="a scene, and what to vary in it")
    add_output(parser)
    parser.add_argument("--jobs", metavar="N", type=int, default=cores(), help="cases at a time (default all cores)")
    parser.add_argument("--figures", action="store_true", help="draw every case")
    parser.add_argument("--no-check", action="store_true", help="do not measure the errors against the reference")


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Run what is missing or failed; exit code 1 when a case failed, 130 when the sweep was interrupted."""
    definition = _definition(arguments)
    end = run_sweep.sweep(
        definition,
        arguments.output,
        processes=arguments.jobs,
        check=not arguments.no_check,
        figures=arguments.figures,
    )
    for name, reason in end.failed:
        print(f"{name}: {reason}")
    before = f" ({end.before} of them before)" if end.before else ""
    failed = f", {len(end.failed)} failed" if end.failed else ""
    print(f"{one_line(arguments.output)}: {end.done} of {end.cases} cases done{before}{failed}")
    data = {"cases": end.cases, "done": end.done, "failed": dict(end.failed)}
    if end.others:
        print(
            f"{end.others} more cases, with values that {one_line(arguments.sweep)} no longer names, remain, also in "
            "the table"
        )
    if end.interrupted:
        print("the sweep was interrupted; completed cases remain, and the same command runs the rest")
        return CommandResult(130, data)
    if end.failed:
        print("the same command runs the failed cases again")
    else:
        print(f"`granchain collect {one_line(arguments.output)}` makes the table")
    return CommandResult(1 if end.failed else 0, data)


def case_decks(
    arguments: argparse.Namespace, accept: Callable[[Scene], None] = lambda _: None
) -> AbstractContextManager[CaseDecks]:
    """Cases of the command's sweep, whose decks are written in place of runs.

    Args:
        arguments: arguments of the command (`add_arguments`).
        accept: called with the scene of each case before anything is written; may raise InputError.

    Returns:
        The cases, in a context that keeps other commands out of the sweep's directory.

    Raises:
        InputError: an option cannot be used; else as `workflow.sweep.case_decks.planned_decks`.

    Examples:
        >>> import argparse
        >>> _ = (tmp / "sweep.yaml").write_text("{scene: one-chain, vary: {kick.velocity: [1.0, 2.0]}}")
        >>> with case_decks(argparse.Namespace(sweep=tmp / "sweep.yaml", output=tmp / "swept", jobs=1)) as decks:
        ...     decks.to_do
        ['kick.velocity=1', 'kick.velocity=2']
    """
    return planned_decks(_definition(arguments), arguments.output, accept)


def _definition(arguments: argparse.Namespace) -> file.Sweep:
    """The sweep of the command's file.

    Raises:
        InputError: it is none, or an option cannot be used.
    """
    if not 1 <= arguments.jobs <= 1024:
        raise InputError(f"--jobs: {arguments.jobs} given; 1 to 1024")
    return file.load(arguments.sweep)
