"""Explain a key of a scene, a quantity, a term or a command."""

import argparse
import textwrap

from lammps_inputs import InputError, handbook, library
from workflow import cli

_LEAST_LETTERS = 3
"""Length of a phrase that is searched for in explanations; shorter ones are symbols."""

EXAMPLES = (
    "help scene                # all keys; units: reduced, or SI with a material",
    "help coupling.rows",
    "help run",
    "help kappa                # a symbol or term",
    "help leading pulse",
    "help agree_1              # a column of the table of `granchain collect`",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the word or phrase."""
    parser.add_argument(
        "words",
        metavar="scene|KEY|COMMAND|QUANTITY|TERM",
        nargs="*",
        help="what to explain, also a phrase of several words (default all commands)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the part of the handbook, or the help of a command."""
    word = " ".join(arguments.words)
    if not word:
        cli.parser(()).print_help()
    elif word == "scene":
        print(handbook.scenes())
    elif word in cli.COMMANDS and handbook.of_key(word) is None:
        cli.main([word, "--help"])
    else:
        dotted = word.replace(" ", ".")
        print(handbook.of_key(word) or _explanations(word) or handbook.of_key(dotted) or _mentions(word))
    return 0


def _explanations(word: str) -> str:
    """What a symbol, term, quantity or word of the manual means, one below the other; empty where it is none."""
    from workflow.verdicts.quantities import explained  # numpy and more, which keys do not need

    names = dict.fromkeys([word, word.replace(" ", "_"), word.replace(" ", ".")])
    quantities = [explained(name) for name in names]
    parts = [handbook.of_term(word), *quantities, handbook.of_word(word), handbook.of_part_of_model(word)]
    return "\n".join(filter(None, parts))


def _mentions(phrase: str) -> str:
    """Names whose explanations hold a phrase.

    Raises:
        InputError: there are none.
    """
    from workflow.sweep.collect import QUANTITIES
    from workflow.verdicts.quantities import places

    explanations = [(names[0], text) for names, text in (*handbook.sections(), *handbook.terms())]
    for place in places():
        explanations.append((".".join(place.path[-2:]), place.quantity.meaning))
        explanations += [(column.name, column.label) for column in place.quantity.columns]
    names = [name for name, text in explanations if len(phrase) >= _LEAST_LETTERS and phrase.lower() in text.lower()]
    if not names:
        hint = library.suggestion(phrase[:200], (*handbook.keys(), *cli.COMMANDS, *QUANTITIES))
        raise InputError(f"help: {phrase[:60]!r} is no key of a scene, no command, no quantity and no term{hint}")
    shown = ", ".join(dict.fromkeys(names))
    text = f"in the explanations of {shown}; `granchain help NAME` prints one"
    return "\n".join([phrase, *textwrap.wrap(text, 100, initial_indent="    ", subsequent_indent="    ")])
