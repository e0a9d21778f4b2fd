"""Explain a key of a scene, a quantity, a term or a command."""

import argparse
import textwrap
from collections.abc import Iterator

from granchain import InputError, Scene
from granchain.parts import cli, complaints
from workflow.plugins.help import handbook, vocabulary

MOST_SHOWN = 6
"""Places that have a phrase and whose explanation is printed; of further ones the names."""

_LEAST_LETTERS = 3
"""Length of a phrase that is searched for in explanations; shorter ones are symbols."""

JOB = "Scenes"
PRINTS = True
TAKES_WORDS = True
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
        section = handbook.of_key(word) or _explanations(word) or handbook.of_key(dotted)
        print(section or handbook.of_ingredient(dotted) or _mentions(word))
    return 0


def _explanations(word: str) -> str:
    """What a symbol, term, quantity or word of the manual means, one below the other; empty where it is none."""
    from workflow.plugins.help.quantities import explained  # numpy and more, which keys do not need

    names = dict.fromkeys([word, word.replace(" ", "_"), word.replace(" ", ".")])
    quantities = [explained(name) for name in names]
    in_tables = handbook.of_word(word) or handbook.of_word(word.rpartition(".")[2])
    parts = [handbook.of_term(word), *quantities, in_tables, handbook.of_part_of_model(word)]
    return "\n".join(filter(None, [*parts, vocabulary.explained(word)]))


def _mentions(phrase: str) -> str:
    """What explanations that hold a phrase say of it.

    Raises:
        InputError: there are none.
    """
    places: dict[str, list[str]] = {}  # of a name that has several meanings all that hold the phrase
    for name, text in _places(phrase) if len(phrase) >= _LEAST_LETTERS else ():
        meanings = places.setdefault(name, [])
        meanings += [text] if text not in meanings else []
    if not places:
        raise InputError(
            f"help: {phrase[:60]!r} is no key of a scene, no command, no quantity and no term{_suggestion(phrase)}"
        )
    explained = [(name, "\n".join(meanings)) for name, meanings in list(places.items())[:MOST_SHOWN]]
    shown = [f"  {name}:\n{textwrap.indent(text, '  ')}" for name, text in explained]
    if len(places) > MOST_SHOWN:
        rest = f"also in the explanations of {', '.join(list(places)[MOST_SHOWN:])}"
        shown += textwrap.wrap(rest, 100, initial_indent="  ", subsequent_indent="  ")
    return "\n".join([phrase, *shown])


def _places(phrase: str) -> Iterator[tuple[str, str]]:
    """Name of each term, quantity, key and option whose explanation holds a phrase, and that explanation."""
    from granchain.parts import places

    def fits(text: str) -> bool:
        return phrase.lower() in text.lower()

    for names, meaning in handbook.terms():
        if fits(meaning):
            yield names[0], "\n".join(textwrap.wrap(meaning, 96, initial_indent="  ", subsequent_indent="  "))
    yield from handbook.mentions(phrase)
    for place in places.places():
        quantity = place.quantity
        if fits(quantity.meaning) or any(fits(column.label) for column in quantity.columns):
            yield ".".join(place.path[-2:]), "\n".join(textwrap.wrap(quantity.meaning, 96, initial_indent="  "))
    for word, explanations in vocabulary.explanations().items():
        for explanation in explanations:
            if fits(explanation.meaning):
                yield word, explanation.text
    for name in cli.COMMANDS:
        if fits(cli.summary_of(name)):
            yield f"granchain {name}", f"  {cli.summary_of(name)}"


def _suggestion(phrase: str) -> str:
    """The word that a phrase is closest to, in brackets: as it stands or in lower case, whole or its last part."""
    from granchain.parts import columns, fields, places

    names = {name for names, _ in handbook.terms() for name in names}
    names |= {*handbook.keys(), *fields.all_fields(Scene), *cli.COMMANDS, *columns.QUANTITIES, *vocabulary.words()}
    names |= {place.path[-1] for place in places.places() if place.path}
    names |= {name.rpartition(".")[2] for name in names}
    spelt = dict.fromkeys([phrase[:200], phrase[:200].lower(), phrase[:200].replace(" ", "_")])
    return next(filter(None, (complaints.suggestion(word, sorted(names)) for word in spelt)), "")
