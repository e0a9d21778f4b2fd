"""Collect the analyses of a sweep in one table, with statistics of a quantity and its figure over the varied fields."""

import argparse
import math
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, strict_yaml
from workflow import screen
from workflow.quantities.columns import QUANTITIES, UNCERTAINTIES
from workflow.runs.files import write_text
from workflow.screen import CommandResult, one_line, print_table
from workflow.sweep import collect as collecting
from workflow.sweep import statistics as grouping
from workflow.sweep.collect import SHOWN, SweepTable
from workflow.sweep.statistics import Group
from workflow.verdicts.quantities import HISTOGRAM, STATISTICS

TABLE = "table.csv"

_MOST_ROWS = 40

ANSWERS = "a list of the table's rows, in the scenes' units; with --statistics of those of statistics.csv"
DRAWS = True
EXAMPLES = (
    "collect swept --plot agree_10 --over coupling.stiffness",
    "collect swept --plot agree_10 --over coupling.stiffness,kick.velocity",
    "collect swept -o table.csv --where beads=120",
    "collect seeds --statistics peak_velocity@100,participation",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the directory, the file, and what to plot."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="of a sweep, also one that came from a cluster")
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help=f"the table (default DIR/{TABLE})")
    parser.add_argument("--plot", metavar="QUANTITY", help=f"draw one of the table's columns: {_numbers()}")
    parser.add_argument(
        "--over",
        metavar="FIELD[,FIELD]",
        help="over this field, or over two as a map with contours; with --statistics the fields of the groups",
    )
    parser.add_argument("--and", metavar="FIELD", dest="beside", help="a line of --plot for each value of this field")
    parser.add_argument(
        "--statistics",
        metavar="QUANTITY,...",
        help="mean, standard error, deviation, quantiles and histogram of columns over the cases; by groups of the "
        "varied fields of --over (default all but seeds)",
    )
    parser.add_argument(
        "--where",
        metavar="FIELD=VALUE",
        action="append",
        default=[],
        help="only such cases, in the table and in the figure",
    )


def _numbers() -> str:
    return ", ".join(name for name, quantity in QUANTITIES.items() if quantity.label)


def execute(arguments: argparse.Namespace) -> CommandResult:
    """Write tables and figures, print the head of the table or the statistics; exit code 1 if these have no value."""
    _refuse_together(arguments)
    if not arguments.directory.is_dir():
        raise InputError(f"{arguments.directory}: no such directory")
    quantities = list(dict.fromkeys(arguments.statistics.split(","))) if arguments.statistics is not None else []
    for option, names in (("--plot", filter(None, [arguments.plot])), ("--statistics", quantities)):
        for name in names:
            collecting.refuse_unless_numeric(option, name)
    where = dict(_condition(text) for text in arguments.where)
    output = arguments.output or arguments.directory / TABLE
    files = {output: b"case,"}
    files |= {output.parent / name: b"quantity" for name in ((STATISTICS, HISTOGRAM) if quantities else ())}
    if quantities and output.name in (STATISTICS, HISTOGRAM):
        raise InputError(f"-o: {output}: --statistics writes another table there; choose another FILE")
    for path, start in files.items():
        _refuse(path, start)
    at_beads = [name for name in filter(None, [arguments.plot, *quantities]) if "@" in name]
    table = collecting.only(collecting.collect(arguments.directory, at_beads), where)
    title = ", ".join(f"{name} = {value}" for name, value in where.items())
    if quantities:
        return _statistics(arguments, table, quantities, output, title)
    figures: tuple[Path, ...] = ()
    if arguments.plot is not None:
        figures = collecting.plot(table, output.parent, arguments.plot, arguments.over, arguments.beside, title)
    write_text(output, table.to_csv())
    _print(table, one_line(arguments.directory), arguments.plot)
    print(f"written: {', '.join(one_line(path) for path in (output, *figures))}")
    return CommandResult(0, [{name: row[name] for name in table.columns} for row in table.rows])


def _refuse_together(arguments: argparse.Namespace) -> None:
    """Refuse options that need another one, or exclude each other."""
    if arguments.plot is not None and arguments.statistics is not None:
        raise InputError("--plot and --statistics: choose one; --statistics draws its figures itself")
    if arguments.plot is not None and arguments.over is None:
        raise InputError("--plot and --over go together: a quantity, and the field to draw it over")
    if arguments.plot is None and arguments.beside is not None:
        raise InputError("--and chooses what --plot draws; give --plot too")
    if arguments.plot is None and arguments.statistics is None and arguments.over is not None:
        raise InputError("--over needs a quantity: --plot QUANTITY or --statistics QUANTITY")


def _statistics(
    arguments: argparse.Namespace, table: SweepTable, quantities: list[str], output: Path, title: str
) -> CommandResult:
    """Write and print statistics by groups of the fields of ``--over``; draw those of quantities that have a value."""
    over = arguments.over
    fields = grouping.default_fields(table) if over is None else collecting.named_fields("--over", over, table)
    by_quantity = [grouping.grouped(table, name, fields) for name in quantities]
    groups = [group for of_quantity in by_quantity for group in of_quantity]
    paths = [output, output.parent / STATISTICS, output.parent / HISTOGRAM]
    contents = table.to_csv(), grouping.statistics_csv(table, groups), grouping.histogram_csv(table, groups)
    for path, content in zip(paths, contents, strict=True):
        write_text(path, content)
    has_value = False
    for of_quantity in by_quantity:
        _print_statistics(table, one_line(arguments.directory), of_quantity)
        if any(group.statistics.values for group in of_quantity):
            has_value = True
            try:
                paths += grouping.plot(table, output.parent, of_quantity, title)
            except InputError as error:
                print(f"there is no figure: {error}")
    print(f"written: {', '.join(one_line(path) for path in paths)}")
    return CommandResult(0 if has_value else 1, [group.plain() for group in groups])


def _print_statistics(table: SweepTable, title: str, groups: list[Group]) -> None:
    """Print a line for each group of a quantity."""
    columns = [name.replace("_", " ") for name in vars(groups[0].statistics)]  # words may stand in two lines
    rows = [
        [screen.cell(value) for value in (*group.fields.values(), *vars(group.statistics).values())] for group in groups
    ]
    head = [table.heading(name) for name in groups[0].fields]
    print_table(f"{title}: {table.heading(groups[0].quantity)}", head + columns, rows)


def _condition(words: str) -> tuple[str, Any]:
    field, equals, value = words.partition("=")
    if not equals:
        raise InputError(f"--where: {words!r} given; FIELD=VALUE, such as beads=40")
    return field, strict_yaml.parse(f"value: {value}", "--where")["value"]


def _refuse(output: Path, start: bytes) -> None:
    """Refuse names that do not end in .csv, and existing files that do not start as a table of ours does."""
    if output.suffix != ".csv":
        raise InputError(f"-o: {output}: the table is CSV, so FILE ends in .csv")
    if not output.parent.is_dir():
        raise InputError(f"-o: {output.parent}: no such directory")
    if output.is_dir():
        raise InputError(f"-o: {output}: is a directory")
    if output.exists() and not output.read_bytes().startswith(start):
        raise InputError(f"-o: {output}: exists and is not a table of granchain's; choose another file")


def _print(table: SweepTable, title: str, drawn: str | None) -> None:
    columns = list(dict.fromkeys([*table.fields, "outcome", *filter(None, [drawn]), *SHOWN]))
    rows = [[cell(name, row) for name in columns] for row in table.rows[:_MOST_ROWS]]
    print_table(title, [table.heading(name) for name in columns], rows)
    if len(table.rows) > _MOST_ROWS:
        print(f"... and {len(table.rows) - _MOST_ROWS} more rows")
    outcomes = [row["outcome"] for row in table.rows]
    counts = ", ".join(f"{outcomes.count(outcome)} {outcome}" for outcome in dict.fromkeys(outcomes))
    print(f"{len(outcomes)} cases: {counts}")


def cell(name: str, row: dict[str, Any]) -> str:
    """What the screen shows of a column in a row of the table; an amplitude with its uncertainty."""
    value = row[name]
    uncertainty = row.get(UNCERTAINTIES.get(name, ""))
    if value is None:
        return "-"
    if isinstance(uncertainty, int | float) and 5e-5 <= uncertainty < math.inf:  # else the four digits are certain
        digits = min(4, max(0, 1 - math.floor(math.log10(uncertainty))))
        return f"{value:.{digits}f} +- {uncertainty:.2g}"
    if isinstance(value, int | float):
        return format(value, SHOWN.get(name, ".6g"))
    return "".join(letter if letter.isprintable() else "?" for letter in str(value))
