"""Explain a key of a scene, a quantity, a term or a command."""

import argparse

from lammps_inputs import InputError, handbook, library
from workflow import cli

EXAMPLES = (
    "help scene                # all keys; units: reduced, or SI with a material",
    "help coupling.rows",
    "help run",
    "help kappa               # a symbol or term",
    "help agree_1             # a column of the table of `granchain collect`",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The word."""
    parser.add_argument(
        "word", metavar="scene|KEY|COMMAND|QUANTITY|TERM", nargs="?", help="what to explain (default all commands)"
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
        found = handbook.of_key(word) or "\n".join(
            filter(None, [handbook.of_term(word), _of_quantity(word), handbook.of_word(word)])
        )
        if not found:
            from workflow.sweep.collect import QUANTITIES

            hint = library.suggestion(word[:200], (*handbook.keys(), *cli.COMMANDS, *QUANTITIES))
            raise InputError(f"help: {word[:60]!r} is no key of a scene, no command, no quantity and no term{hint}")
        print(found)
    return 0


def _of_quantity(word: str) -> str | None:
    from workflow.verdicts.quantities import explained  # numpy and more, which other words do not need

    return explained(word)
