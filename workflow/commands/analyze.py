"""Find the pulses in a run, measure them and draw them.

Plug-ins take this module to add to the command: `analysis_of` makes its analysis, `report` prints it, with further
tables.

Examples:
    >>> import argparse
    >>> scene = granchain.load("one-chain", {"beads": 20, "duration": 30.0})
    >>> done = granchain.run(scene, tmp / "run", engine="reference")
    >>> arguments = argparse.Namespace(directory=tmp / "run", beads=None, no_figures=True, arrival=None)
    >>> analyze.analysis_of(arguments)
    <analysis of one-chain: 1 pulse was tracked>
"""

import argparse
import json
from pathlib import Path

from analysis.tracking.leading_waves import ARRIVALS
from lammps_inputs import InputError
from workflow.runs.run_directory import RunDirectory
from workflow.screen import CommandResult, print_files, print_heading, print_table
from workflow.verdicts.analyse import Analysis
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.analysis_lines import lines
from workflow.verdicts.analysis_report import REPORT

ANSWERS = "what analysis.json holds"
DRAWS = True
EXAMPLES = (
    "analyze demo",
    "analyze demo --beads 10,55,90 --formats pdf --width 3.4",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the directory and what to draw."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="a run directory, also from a cluster")
    parser.add_argument("--beads", metavar="N,N,...", help="beads whose velocity over time is drawn")
    parser.add_argument(
        "--arrival",
        choices=ARRIVALS,
        help="a wave arrives when the bead is fastest, or at the centre of the impulse that made it so; by default "
        "the latter where beads have gaps",
    )


def add_last_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what stands after the options of plug-ins."""
    parser.add_argument("--no-figures", action="store_true", help="write the tables only")


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print a short table; write waves.csv, analysis.json and figures."""
    return report(arguments, analysis_of(arguments))


def analysis_of(arguments: argparse.Namespace) -> Analysis:
    """The analysis of the command's run, which is written beside the frames."""
    return analyse(
        RunDirectory(arguments.directory),
        beads=_beads(arguments.beads),
        figures=not arguments.no_figures,
        arrival=arguments.arrival,
    )


def report(
    arguments: argparse.Namespace, analysis: Analysis, *tables: tuple[str, list[str], list[list[str]]]
) -> CommandResult:
    """Print an analysis, and the files that were written.

    Args:
        arguments: arguments of the command.
        analysis: what `analysis_of` returned.
        tables: further tables, each of title, headings and rows.

    Returns:
        The command's result, with what ``analysis.json`` holds.
    """
    print_heading(analysis.problem.name, RunDirectory(arguments.directory).scene.units)
    for line in (*lines(analysis), *tables):
        if isinstance(line, str):
            print(line)
        else:
            print_table(*line)
    names = [*analysis.tables, REPORT, *(path.name for path in analysis.figures)]
    print_files(arguments.directory, names)
    return CommandResult(0, json.loads((arguments.directory / REPORT).read_text(encoding="utf-8")))


def _beads(text: str | None) -> tuple[int, ...] | None:
    if text is None:
        return None
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--beads: {text!r} given; bead numbers with commas between, such as 10,55,90") from None
