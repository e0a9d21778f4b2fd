"""Say what a key of a scene or a quantity means, or how a command is used."""

import argparse
from typing import TYPE_CHECKING

from lammps_inputs import InputError, handbook, library
from workflow import cli

if TYPE_CHECKING:
    from workflow.sweep.table import Quantity

EXAMPLES = (
    "help scene                # all keys; units: reduced, or SI with a material",
    "help coupling.rows",
    "help run",
    "help agree_1             # a column of the table of `granchain collect`",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The word."""
    parser.add_argument(
        "word", metavar="scene|KEY|COMMAND|QUANTITY", nargs="?", help="what to explain (default all commands)"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the part of the handbook, or the help of a command."""
    word = arguments.word
    if word is None:
        cli.parser(()).print_help()
    elif word == "scene":
        print(handbook.scenes())
    elif word in cli.COMMANDS and handbook.of_key(word) is None:
        cli.main([word, "--help"])
    else:
        from workflow.sweep.table import QUANTITIES  # numpy and more, which other words do not need

        found = handbook.of_key(word)
        if found is None and word in QUANTITIES:
            found = _quantity(word, QUANTITIES[word])
        found = found or handbook.of_word(word)
        if found is None:
            hint = library.suggestion(word[:200], (*handbook.keys(), *cli.COMMANDS, *QUANTITIES))
            raise InputError(f"help: {word[:60]!r} is no key of a scene, no command and no quantity{hint}")
        print(found)
    return 0


def _quantity(name: str, quantity: "Quantity") -> str:
    """What a column of the table of a sweep holds, and where it stands in a run directory."""
    units = dict.fromkeys(quantity.unit(si=si) for si in (False, True))
    unit = f"; unit: {', '.join(units)}" if any(units) else ""
    meaning = f"    {quantity.words}{unit}\n" if quantity.words else ""
    place = " > ".join("waves of the kicked chain" if key == "hit" else key for key in quantity.path)
    return f"{name}\n{meaning}    column of `granchain collect`; {quantity.file}: {place}"
