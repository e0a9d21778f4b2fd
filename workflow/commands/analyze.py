"""Find the pulses in a run, measure them and draw them."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from analysis.tracking.leading_waves import ARRIVALS
from lammps_inputs import InputError
from workflow.runs.run_directory import RunDirectory
from workflow.screen import CommandResult, print_files, print_heading, print_table
from workflow.study_kit.gradient import of_run, with_derivatives
from workflow.verdicts.analyse import analyse
from workflow.verdicts.analysis_lines import lines
from workflow.verdicts.analysis_report import REPORT
from workflow.verdicts.derivative import HEAD

ANSWERS = "what analysis.json holds; with --gradient also the derivatives"
DRAWS = True
EXAMPLES = (
    "analyze demo",
    "analyze demo --beads 10,55,90 --formats pdf --width 3.4",
    "analyze demo --gradient peak_velocity@50,arrival@50 --by coupling.stiffness",
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
    parser.add_argument(
        "--gradient",
        metavar="Q,Q,...",
        help="compute derivatives of quantities by fields of the scene, with the reference; at a bead: arrival@50",
    )
    parser.add_argument("--by", metavar="FIELD,...", help="fields for --gradient (default all numbers of the scene)")
    parser.add_argument("--no-figures", action="store_true", help="write the tables only")


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Print a short table; write waves.csv, analysis.json and figures, and with ``--gradient`` gradient.csv."""
    directory = RunDirectory(arguments.directory)
    by = None if arguments.by is None else arguments.by.split(",")
    derivatives = of_run(directory, () if arguments.gradient is None else arguments.gradient.split(","), by)
    analysis = analyse(
        directory,
        beads=_beads(arguments.beads),
        figures=not arguments.no_figures,
        arrival=arguments.arrival,
    )
    analysis = with_derivatives(analysis, directory, derivatives)
    print_heading(analysis.problem.name, directory.scene.units)
    for line in lines(analysis):
        if isinstance(line, str):
            print(line)
        else:
            print_table(*line)
    if analysis.derivatives:
        print_table("derivatives of quantities by fields", HEAD, [line.cells() for line in analysis.derivatives])
    names = [*analysis.tables, REPORT, *(path.name for path in analysis.figures)]
    print_files(arguments.directory, names)
    data = json.loads((arguments.directory / REPORT).read_text(encoding="utf-8"))
    more = {"gradient": [asdict(line) for line in analysis.derivatives]} if analysis.derivatives else {}
    return CommandResult(0, data | more)


def _beads(text: str | None) -> tuple[int, ...] | None:
    if text is None:
        return None
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--beads: {text!r} given; bead numbers with commas between, such as 10,55,90") from None
