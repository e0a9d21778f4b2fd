"""Collect the analyses of a sweep in one table, and plot a quantity over the varied fields."""

import argparse
import math
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, strict_yaml
from workflow.runs.files import write_text
from workflow.screen import Answer, one_line, print_table
from workflow.sweep import collect as collecting
from workflow.sweep.collect import QUANTITIES, SHOWN, UNCERTAINTIES, Table

TABLE = "table.csv"

_MOST_ROWS = 40

ANSWERS = "a list of the table's rows, in the scenes' units"
DRAWS = True
EXAMPLES = (
    "collect swept --plot agree_10 --over coupling.stiffness",
    "collect swept -o table.csv --where beads=120",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The directory, the file, and what to plot."""
    parser.add_argument("directory", metavar="DIR", type=Path, help="of a sweep, also one that came from a cluster")
    parser.add_argument("-o", "--output", metavar="FILE", type=Path, help=f"the table (default DIR/{TABLE})")
    parser.add_argument("--plot", metavar="QUANTITY", help=f"draw one of the table's columns: {_numbers()}")
    parser.add_argument("--over", metavar="FIELD", help="over this field")
    parser.add_argument("--and", metavar="FIELD", dest="beside", help="and over this one: as lines, or as a map")
    parser.add_argument(
        "--where",
        metavar="FIELD=VALUE",
        action="append",
        default=[],
        help="only such cases, in the table and in the figure",
    )


def _numbers() -> str:
    return ", ".join(name for name, quantity in QUANTITIES.items() if quantity.label)


def execute(arguments: argparse.Namespace) -> Answer:
    """Write the table and figure, print the table's head."""
    if (arguments.plot is None) != (arguments.over is None):
        raise InputError("--plot and --over go together: a quantity, and the field to draw it over")
    if arguments.plot is None and arguments.beside is not None:
        raise InputError("--and chooses what --plot draws; give --plot too")
    where = dict(_condition(text) for text in arguments.where)
    output = arguments.output or arguments.directory / TABLE
    _refuse(output)
    table = collecting.only(collecting.collect(arguments.directory), where)
    figures: tuple[Path, ...] = ()
    if arguments.plot is not None:
        title = ", ".join(f"{name} = {value}" for name, value in where.items())
        figures = collecting.plot(table, output.parent, arguments.plot, arguments.over, arguments.beside, title)
    write_text(output, table.to_csv())
    _print(table, one_line(arguments.directory), arguments.plot)
    print(", ".join(one_line(path) for path in (output, *figures)))
    return Answer(0, [{name: row[name] for name in table.columns} for row in table.rows])


def _condition(words: str) -> tuple[str, Any]:
    field, equals, value = words.partition("=")
    if not equals:
        raise InputError(f"--where: {words!r} given; FIELD=VALUE, such as beads=40")
    return field, strict_yaml.parse(f"value: {value}", "--where")["value"]


def _refuse(output: Path) -> None:
    """Refuse formats that there is no library for, and files that are not a table of ours."""
    if output.suffix != ".csv":
        raise InputError(f"-o: {output}: the table is CSV, so FILE ends in .csv")
    if not output.parent.is_dir():
        raise InputError(f"-o: {output.parent}: no such directory")
    if output.is_dir():
        raise InputError(f"-o: {output}: is a directory")
    if output.exists() and not output.read_bytes()[:5] == b"case,":
        raise InputError(f"-o: {output}: exists and is not a table of granchain's; choose another file")


def _print(table: Table, title: str, drawn: str | None) -> None:
    columns = list(dict.fromkeys([*table.fields, "outcome", *filter(None, [drawn]), *SHOWN]))
    rows = [[cell(name, row) for name in columns] for row in table.rows[:_MOST_ROWS]]
    print_table(title, [table.heading(name) for name in columns], rows)
    if len(table.rows) > _MOST_ROWS:
        print(f"... and {len(table.rows) - _MOST_ROWS} more")
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
