"""`granchain help` explains every word that it lists, and suggests one for a word that is nearly one of them."""

import contextlib
import re
import sys
from types import SimpleNamespace

import pytest
from plug_ins import needs

from lammps_inputs import InputError, Scene
from workflow import cli
from workflow.cli import COMMANDS, main
from workflow.plugins.help import handbook, vocabulary
from workflow.plugins.help import tool as helping
from workflow.quantities.columns import QUANTITIES
from workflow.study_kit.options import example_file
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


@pytest.mark.slow
@pytest.mark.parametrize("kind", NAMES)
def test_every_near_miss_is_explained_or_suggested(kind, capsys):
    bare = []
    for word in dict.fromkeys(name.lstrip("-") for name in NAMES[kind] if len(name) > 5):
        try:
            explanation(near(word), capsys)
        except InputError as error:
            bare += [word] * ("did you mean" not in str(error))
    assert bare == []


@pytest.mark.parametrize("name", ["sweep", pytest.param("design", marks=needs("design"))])
def test_help_of_a_command_shows_the_file_that_it_takes(name, capsys):
    with pytest.raises(SystemExit):
        main([name, "--help"])
    usage = capsys.readouterr().out
    assert main(["help", "vary"]) == 0
    lines = capsys.readouterr().out
    for line in example_file(sys.modules[vocabulary.kinds()[name]]).splitlines():
        assert line in usage
        assert line in lines
