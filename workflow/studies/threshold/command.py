"""Find where a quantity crosses a value as a field of the scene varies, with its uncertainty."""

import argparse
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, library
from workflow.engines.lammps.mpi import cores
from workflow.formats import figure_files
from workflow.screen import Answer, count_bar, one_line, print_table
from workflow.studies.options import number, second_field, split
from workflow.studies.threshold import study
from workflow.studies.threshold.bracket import Axis
from workflow.studies.threshold.study import Found, Question, Threshold
from workflow.sweep import fields
from workflow.workers.pool import Pool

ANSWERS = "the thresholds, and how many scenes were computed"
DRAWS = True
EXAMPLES = (
    "threshold two-chains --where agree_1=100 --vary coupling.stiffness=0.02:0.5 --log -o found",
    "threshold two-chains --where agree_1=100 --vary coupling.stiffness=0.02:0.5 --log --over chains=2,3,4 -o curve",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The question, where to, and how."""
    parser.add_argument("scene", metavar="SCENE", help="the scene; its other fields are constant")
    parser.add_argument(
        "--where", metavar="QUANTITY=VALUE", required=True, help="a quantity of `granchain collect`, in its units"
    )
    parser.add_argument("--vary", metavar="FIELD=LOW:HIGH", required=True, help="the varied field, and its range")
    parser.add_argument("--log", action="store_true", help="divide the range by factors instead of differences")
    parser.add_argument("--over", metavar="FIELD=A,B,...", help="one threshold for each value of a second field")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="made, or resumed")
    parser.add_argument("--points", metavar="N", type=int, default=9, help="values of the first scan (default 9)")
    parser.add_argument(
        "--tolerance", metavar="X", type=float, default=1e-3, help="largest half-width of a bracket / its place"
    )
    parser.add_argument("--jobs", metavar="N", type=int, default=cores(), help="scenes at a time (default all cores)")


def execute(arguments: argparse.Namespace) -> Answer:
    """Print the thresholds; exit code 1 without any, 130 when interrupted, with all that was computed kept."""
    if not 1 <= arguments.jobs <= 1024:
        raise InputError(f"--jobs: {arguments.jobs} given; 1 to 1024")
    question = _question(arguments)
    print(f"{one_line(arguments.scene)}: {study.cost(question)}", flush=True)
    try:
        with count_bar("threshold") as progress, Pool(arguments.jobs, interrupt=True) as pool:
            found = study.carry_out(question, arguments.output, pool=pool, progress=progress)
    except KeyboardInterrupt:
        print("interrupted: computed scenes remain; the same command resumes")
        return Answer(130, {})
    _print(found, arguments.output)
    return Answer(0 if found.thresholds else 1, found.plain())


def _question(arguments: argparse.Namespace) -> Question:
    name = arguments.scene
    plain = library.find(name).plain()
    quantity, level = split(arguments.where, "--where", "agree_1=100")
    field, ends = split(arguments.vary, "--vary", "coupling.stiffness=0.02:0.5")
    over, values = second_field(arguments.over)
    low, high = (number(end, "--vary", "FIELD=0.02:0.5") for end in (*ends.split(":", 1), "")[:2])
    try:
        whole = fields.is_whole(fields.parse(field, plain))
    except InputError as error:
        raise InputError(f"--vary: {error}") from None
    if not low < high or (arguments.log and low <= 0.0):
        above = ", both above 0 with --log" if arguments.log else ""
        raise InputError(f"--vary: {ends} given; the smaller number first{above}, such as 0.02:0.5")
    if whole and not (low.is_integer() and high.is_integer()):
        raise InputError(f"--vary: {field} takes whole numbers; {ends} given")
    if not 2 <= arguments.points <= 10_000:
        raise InputError(f"--points: {arguments.points} given; 2 to 10000")
    if not 1e-12 <= arguments.tolerance <= 0.5:
        raise InputError(f"--tolerance: {arguments.tolerance:g} given; 1e-12 to 0.5")
    axis = Axis(low, high, arguments.log, whole, arguments.points, arguments.tolerance)
    return Question(name, plain, quantity, number(level, "--where", "agree_1=100"), field, axis, over, values)


def _print(found: Found, output: Path) -> None:
    asked = found.question
    if found.thresholds:
        head = [asked.heading(name) for name in (asked.over, asked.field) if name]
        print_table(
            f"{one_line(asked.source)}: where {asked.quantity} crosses {asked.level:g}",
            [*head, "uncertainty", "from", "to", asked.quantity, ""],
            [[*([_text(one.over)] if asked.over else []), *_row(one)] for one in found.thresholds],
        )
    for over in asked.lines:
        if missing := found.missing(over):
            print(one_line(missing))
    files = ", ".join((study.TABLE, study.POINTS, *figure_files(study.FIGURE)))
    print(f"{len(found.points)} scenes computed; {one_line(output)}: {files}")


def _row(one: Threshold) -> list[str]:
    uncertainty = "-" if one.uncertainty is None else f"{one.uncertainty:.2g}"
    notes = ["both sides alternate"] * one.mixed + ["undefined between"] * one.undefined
    numbers = [f"{value:.6g}" for value in (one.low, one.high)]
    return [f"{one.place:.6g}", uncertainty, *numbers, "rises" if one.rises else "falls", ", ".join(notes)]


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else one_line(value)
