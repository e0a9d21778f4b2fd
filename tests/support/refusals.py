"""What every command does with what it cannot use: one line on standard error, exit code 2, and nothing written."""

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
