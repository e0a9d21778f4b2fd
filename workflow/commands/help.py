"""Say what a key of a scene means, or how a command is used."""

import argparse

from lammps_inputs import InputError, handbook, library
from workflow import cli

EXAMPLES = (
    "help scene                # all keys; units: reduced, or SI with a material",
    "help coupling.rows",
    "help run",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The word."""
    parser.add_argument("word", metavar="scene|KEY|COMMAND", nargs="?", help="what to explain (default all commands)")


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
        found = handbook.of_key(word)
        if found is None:
            hint = library.suggestion(word[:200], (*handbook.keys(), *cli.COMMANDS))
            raise InputError(f"help: {word[:60]!r} is no key of a scene and no command{hint}")
        print(found)
    return 0
