"""What no command can use: one line that says what is wrong, exit code 2, and nothing written."""

import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from refusal_rows import Part, assert_refused, cases, written

from workflow.cli import main

pytestmark = pytest.mark.usefixtures("lammps_here", "pool_here")


@pytest.fixture(scope="session")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Part], Path]:
    """A function: directory that the command lines before the rows of a part have filled, once for all of them."""
    made: dict[int, Path] = {}

    def directory(part: Part) -> Path:
        if id(part) not in made:
            made[id(part)] = tmp_path_factory.mktemp("prepared")
            with pytest.MonkeyPatch.context() as patch:
                patch.chdir(made[id(part)])
                written(part.files)
                for line in part.before:
                    assert main(shlex.split(line)) == 0
        return made[id(part)]

    return directory


@pytest.mark.parametrize(("part", "row"), cases())
def test_what_cannot_be_used_is_one_line_and_nothing_is_written(part, row, prepared, tmp_path, monkeypatch, capsys):
    for name in ("home", "here"):
        (tmp_path / name).mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))  # without defaults of whoever runs the tests
    monkeypatch.delenv("GRANCHAIN_SITE", raising=False)
    monkeypatch.chdir(tmp_path / "here")
    assert_refused(part, row, prepared, capsys)
