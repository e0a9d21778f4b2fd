"""Statistics of quantities of a scene over the seeds of its random ingredients."""

import argparse
import functools
from pathlib import Path

from lammps_inputs import InputError, library
from workflow.formats import figure_files
from workflow.screen import Answer, cell, one_line, print_table
from workflow.studies.ensemble import study
from workflow.studies.ensemble.study import Found, Question
from workflow.studies.measures import heading
from workflow.studies.options import add_jobs, add_output, number, on_cores, second_field, within
from workflow.sweep.file import MAX_CASES

ANSWERS = "the statistics, and the seeds"
DRAWS = True
EXAMPLES = (
    "ensemble disordered-chain --seeds 0:199 --quantity peak_velocity@100 -o found",
    "ensemble disordered-chain --seeds 0:99 --over disorder.mass=0.05,0.1,0.2,0.4 --quantity participation -o spread",
)

_HEADS = {
    "values": "values",
    "undefined": "undefined",
    "mean": "mean",
    "interval_95": "+- (95 %)",
    "standard_error": "standard error",
    "standard_deviation": "standard deviation",
    "seeds_needed": "",
}
"""Statistic -> head in the printed table; the last says which precision needs so many seeds."""

_QUANTILES = {"q2_5": "2.5 %", "q16": "16 %", "q50": "50 %", "q84": "84 %", "q97_5": "97.5 %"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The ensemble, where to, and how."""
    parser.add_argument(
        "scene", metavar="SCENE", help="the scene, with `disorder` or random contacts; its other fields are constant"
    )
    parser.add_argument("--seeds", metavar="FIRST:LAST", required=True, help="the seeds, both ends included")
    parser.add_argument(
        "--quantity",
        metavar="NAME",
        action="append",
        help="of `granchain collect`, or of the leading wave at a bead: peak_velocity@100; several times for several "
        "(default peak_velocity)",
    )
    parser.add_argument("--over", metavar="FIELD=A,B,...", help="one ensemble for each value of a second field")
    parser.add_argument(
        "--precision",
        metavar="X",
        type=within(float, 1e-9, 1.0),
        default=0.01,
        help="wished half-width of the 95%% interval / the mean, to say how many seeds it needs (default 0.01)",
    )
    add_output(parser)
    add_jobs(parser)


def execute(arguments: argparse.Namespace) -> Answer:
    """Print the statistics; exit code 1 without any value, 130 when interrupted, with all that was computed kept."""
    question = _question(arguments)
    found = on_cores("ensemble", arguments.jobs, functools.partial(study.carry_out, question, arguments.output))
    if found is None:
        return Answer(130, {})
    _print(found, arguments.output)
    return Answer(0 if found.defined else 1, found.plain())


def _question(arguments: argparse.Namespace) -> Question:
    first, last = (number(end, "--seeds", "0:199") for end in (*arguments.seeds.split(":", 1), "")[:2])
    if not (first.is_integer() and last.is_integer() and 0 <= first <= last < 2**32 and last - first < MAX_CASES):
        raise InputError(f"--seeds: {arguments.seeds} given; whole numbers, the smaller one first, such as 0:199")
    over, values = second_field(arguments.over)
    return Question(
        arguments.scene,
        library.find(arguments.scene).plain(),
        tuple(dict.fromkeys(arguments.quantity or ["peak_velocity"])),
        range(int(first), int(last) + 1),
        arguments.precision,
        over,
        values,
    )


def _print(found: Found, output: Path) -> None:
    asked = found.question
    needed = f"seeds for {100.0 * asked.precision:g} %"
    seeds = f"seeds {asked.seeds[0]} to {asked.seeds[-1]}"
    for name in asked.quantities:
        title = f"{one_line(asked.source)}: {heading(name, asked.scene)}"
        for heads, what in ((_HEADS, seeds), (_QUANTILES, "quantiles")):
            rows = [
                [cell(over)] * bool(asked.over) + [cell(getattr(one, key)) for key in heads]
                for (quantity, over), one in found.statistics.items()
                if quantity == name
            ]
            head = [*(heading(field, asked.scene) for field in [asked.over] if field), *heads.values()]
            print_table(f"{title}, {what}", [word or needed for word in head], rows)
    if found.refused:
        print(one_line(f"some scenes cannot be computed: {found.refused}"))
    files = ", ".join((study.TABLE, study.SEEDS, *figure_files(*(asked.files[name] for name in found.defined))))
    print(f"{len(found.seeds)} scenes computed; {one_line(output)}: {files}")
