"""Find where a quantity crosses a value as a field of the scene varies, with its uncertainty."""

import argparse
import functools
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.formats import figure_files
from workflow.screen import Answer, cell, one_line, print_table
from workflow.studies.measures import heading
from workflow.studies.options import add_jobs, add_output, number, on_cores, second_field, split, within
from workflow.studies.threshold import study
from workflow.studies.threshold.bracket import Axis
from workflow.studies.threshold.study import Found, Question, Threshold
from workflow.sweep import fields

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
    words = ("values of the first scan (default 9)", "largest half-width of a bracket / its place (default 0.001)")
    parser.add_argument("--points", metavar="N", type=within(int, 2, 10_000), default=9, help=words[0])
    parser.add_argument("--tolerance", metavar="X", type=within(float, 1e-12, 0.5), default=1e-3, help=words[1])
    add_output(parser)
    add_jobs(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Print the thresholds; exit code 1 without any, 130 when interrupted, with all that was computed kept."""
    question = _question(arguments)
    found = on_cores("threshold", arguments.jobs, functools.partial(study.carry_out, question, arguments.output))
    if found is None:
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
    axis = Axis(low, high, arguments.log, whole, arguments.points, arguments.tolerance)
    return Question(name, plain, quantity, number(level, "--where", "agree_1=100"), field, axis, over, values)


def _print(found: Found, output: Path) -> None:
    asked = found.question
    if found.thresholds:
        head = [heading(name, asked.scene) for name in (asked.over, asked.field) if name]
        print_table(
            f"{one_line(asked.source)}: where {asked.quantity} crosses {asked.level:g}",
            [*head, "uncertainty", "from", "to", asked.quantity, ""],
            [[*([cell(one.over)] if asked.over else []), *_row(one)] for one in found.thresholds],
        )
    for over in asked.lines:
        if missing := found.missing(over):
            print(one_line(missing))
    files = ", ".join((study.TABLE, study.POINTS, *figure_files(study.FIGURE)))
    print(f"{len(found.points)} scenes computed; {one_line(output)}: {files}")


def _row(one: Threshold) -> list[str]:
    notes = ["both sides alternate"] * one.mixed + ["undefined between"] * one.undefined
    numbers = [cell(one.place), cell(one.uncertainty, ".2g"), cell(one.low), cell(one.high)]
    return [*numbers, "rises" if one.rises else "falls", ", ".join(notes)]
