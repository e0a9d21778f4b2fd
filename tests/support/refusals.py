"""What every command does with what it cannot use: one line on standard error, exit code 2, and nothing written."""

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from workflow import screen
from workflow.cli import main


def refusal(words: Any, capsys: pytest.CaptureFixture[str], code: int = 2) -> str:
    """The one line that a command ends with, without the name in front, and with this exit code."""
    capsys.readouterr()
    with screen.without_bars():  # nor hints, which depend on what was compiled before
        assert main([str(word) for word in words]) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("granchain: ")
    assert err.endswith("\n")
    assert len(err.splitlines()) == 1
    assert err[:-1].isprintable()
    return err.removeprefix("granchain: ").rstrip("\n")


def tree(directory: Path) -> dict[Path, bytes | None]:
    """Everything below a directory with its contents, so that nothing can be written unseen."""
    return {
        path.relative_to(directory): path.read_bytes() if path.is_file() and not path.is_symlink() else None
        for path in directory.rglob("*")
        if not path.is_symlink()
    }


def assert_command_line_is_refused(
    words: str, message: str, files: Mapping[str, str], directory: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A command line, typed in an empty directory with those of these files that it names, is bad input.

    Args:
        words: the line, without the name of the program.
        message: what the one line on standard error must contain.
        files: name -> content.
        directory: where to make that directory, and a home without defaults of whoever runs the tests.
        capsys: of the test.
    """
    home, place = directory / "home", directory / "place"
    home.mkdir()
    place.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        patch.setenv("HOME", str(home))
        patch.delenv("GRANCHAIN_SITE", raising=False)
        for name in files.keys() & set(words.split()):
            Path(name).write_text(files[name], encoding="utf-8")
        before = tree(place)
        assert message in refusal(shlex.split(words), capsys)
        assert tree(place) == before


def assert_file_is_refused(
    command: str, text: str, message: str, directory: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file of this content, given to a command that takes one, is bad input: the one line begins with its path."""
    path = directory / f"{command}.yaml"
    path.write_text(text, encoding="utf-8")
    line = refusal([command, path, "-o", directory / "out"], capsys)
    assert line.startswith(f"{path}: ")
    assert message in line
    assert list(tree(directory)) == [Path(path.name)]
