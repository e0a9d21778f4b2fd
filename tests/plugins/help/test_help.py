"""`granchain help` explains every word that it lists, and suggests one for a word that is nearly one of them."""

import contextlib
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from plug_ins import needs

from lammps_inputs import InputError, Scene
from workflow import cli
from workflow.cli import COMMANDS, main
from workflow.plugins.help import handbook, vocabulary
from workflow.plugins.help import tool as helping
from workflow.plugins.help.quantities import explained, manual
from workflow.quantities.columns import QUANTITIES
from workflow.sweep import fields
from workflow.verdicts.places import places

OPTIONS = sorted(
    {
        option
        for name in COMMANDS
        for action in next(each for each in cli.parser([name])._actions if each.choices and name in each.choices)
        .choices[name]
        ._actions
        for option in action.option_strings
        if option.startswith("--")
    }
)
NAMES = {
    "keys": [*handbook.keys(), *fields.all_fields(Scene)],
    "options": OPTIONS,
    "quantities": [*QUANTITIES, *(place.path[-1] for place in places() if place.path)],
    "terms": [
        names[0] for names, _ in handbook.terms() if re.search(r"[A-Za-z]", names[0]) and "symbol" not in names[0]
    ],
    "words of choices": vocabulary.words(),
}
NETCDF = pytest.param("netcdf", marks=needs("export"))


def explanation(word, capsys):
    with contextlib.suppress(SystemExit):  # after the help of a command
        helping.execute(SimpleNamespace(words=word.split()))
    return capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("kind", NAMES)
def test_every_word_that_help_lists_is_explained(kind, capsys):
    names = dict.fromkeys(NAMES[kind])
    assert len(names) > 20
    unexplained = []
    for word in names:
        try:
            text = explanation(word.lstrip("-"), capsys)
        except InputError as error:
            unexplained.append(str(error))
            continue
        meaning = text.removeprefix(word.lstrip("-")).strip()
        if len(meaning) < 4 or "`granchain help NAME`" in text or "explains each" in text:
            unexplained.append(word)
    assert unexplained == []


def near(word):
    """The word without a letter in its middle."""
    half = len(word) // 2
    return word[:half] + word[half + 1 :]


@pytest.mark.parametrize(
    "word",
    [
        *("kappa", "theta", "coupling", "restitution", "--restart-every", "amplitude", "steel"),
        NETCDF,
        pytest.param("lyapunov", marks=needs("lyapunov")),
    ],
)
def test_a_near_miss_is_suggested_whatever_kind_of_word_it_is(word, capsys):
    for misspelt in (near(word), near(word).upper()):
        assert main(["help", misspelt]) == 2
        assert f"did you mean `{word.lstrip('-')}" in capsys.readouterr().err


def said(capsys, *words):
    assert main(list(words)) == 0
    return capsys.readouterr().out


def test_help_explains_keys_phrases_results_sections_of_the_model_and_terms_of_verdicts(capsys, golden):
    asked = ("restitution", "tension", "beat length", "peak velocity", "budget.closed", "contact constant", "steady")
    golden("phrases", "\n".join(f"{words}\n{said(capsys, 'help', *words.split())}" for words in asked))


def test_a_phrase_is_shown_in_every_explanation_that_holds_it(capsys):
    lines = said(capsys, "help", "half", "of").splitlines()
    assert lines[0] == "half of"
    names = [line.strip().removesuffix(":") for line in lines if line.startswith("  ") and line.endswith(":")]
    assert {"passage time", "beat length", "walls"} <= set(names)
    more = " ".join(said(capsys, "help", "of", "the").split()).partition("also in the explanations of ")[2]
    assert len(more.split(", ")) > 3


def test_help_without_a_word_prints_what_the_program_alone_does(capsys):
    assert said(capsys, "help") == said(capsys)


@pytest.mark.parametrize("name", QUANTITIES)
def test_help_says_where_a_quantity_stands(name, capsys):
    lines = said(capsys, "help", name).splitlines()
    assert name == lines[0]
    assert any(
        line.strip().startswith(QUANTITIES[name].file) and line.endswith(QUANTITIES[name].path[-1]) for line in lines
    )
    assert any(line.strip().startswith("granchain collect: column") and name in line for line in lines)


PAGE = Path(__file__).parents[3] / "analysis" / "QUANTITIES.md"


@needs("rigid", "sound")
def test_the_manuals_page_is_what_the_types_declare():
    assert PAGE.read_text(encoding="utf-8") == manual(), (
        "python -m workflow.plugins.help.quantities > analysis/QUANTITIES.md"
    )


def test_help_says_unit_symbol_meaning_and_every_place_of_a_quantity_also_at_a_bead(golden):
    golden("quantities", "\n\n".join(explained(name) or "" for name in ("wall_force", "arrival")))
    assert explained("arrival@30") == explained("arrival")
    assert [explained(name) for name in ("no_such", "wall_force@30")] == [None] * 2
