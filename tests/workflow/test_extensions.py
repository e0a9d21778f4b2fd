"""Plug-ins that add options to a command (`lammps_inputs.plugins`, ``granchain.options.COMMAND``)."""

import argparse
from types import SimpleNamespace

import pytest

from lammps_inputs import plugins
from workflow import cli


def extension(option, prints):
    """An extension that prints a word before the command, and stands in place of it where its option is given."""

    def add_arguments(parser):
        parser.add_argument(f"--{option}", action="store_true", help=f"help of {option}")

    def execute(arguments, command):
        prints.append(option)
        return 7 if getattr(arguments, option) else command(arguments)

    return SimpleNamespace(add_arguments=add_arguments, execute=execute, EXAMPLES=(), ANSWERS="")


@pytest.mark.parametrize(
    ("words", "code", "printed"),
    [
        ([], 5, ["second", "first", "command"]),
        (["--first"], 7, ["second", "first"]),
        (["--second"], 7, ["second"]),
    ],
)
def test_extensions_wrap_one_another_and_the_command(words, code, printed, monkeypatch):
    prints = []
    both = {name: extension(name, prints) for name in ("first", "second")}
    monkeypatch.setattr(plugins, "loaded", lambda kind: both if kind == "options.status" else {})
    parser = argparse.ArgumentParser("granchain status")
    execute = lambda _: prints.append("command") or 5  # noqa: E731
    cli.fill(parser, SimpleNamespace(add_arguments=lambda _: None, execute=execute, EXAMPLES=(), ANSWERS=""))
    arguments = parser.parse_args(words)
    assert arguments.execute(arguments) == code
    assert prints == printed
