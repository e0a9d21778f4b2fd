"""What no command can use: one line that says what is wrong, exit code 2, and nothing written."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from refusal_rows import Part, assert_refused, cases, pattern, written
from refusals import refusal, tree

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


SCENE = "name: a\nbeads: 9\nkick: {velocity: 1}\nduration: 5\n"
UNREADABLE = {
    "no such file": lambda _: None,
    "is a directory": lambda path: path.mkdir(),
    "cannot be read (": lambda path: path.symlink_to("/proc/self/mem"),
    "cannot be read": lambda path: path.symlink_to(path),
    "not a text file": lambda path: path.write_bytes(SCENE.encode("utf-16")),
    "unacceptable character": lambda path: path.write_bytes(bytes(4096)),
    "8192 KiB": lambda path: path.write_bytes(b"#" * (1 << 24)),
    "nested too deeply": lambda path: path.write_text("output: " + "[" * 5_000),
    "number too long": lambda path: path.write_text(f"{SCENE}chains: {'9' * 5_000}"),
    "chains: should be ... 999... given": lambda path: path.write_text(f"{SCENE}chains: {'9' * 400}"),
    "coupling.force: ... characters; at most 300": lambda path: path.write_text(
        f"{SCENE}chains: 2\ncoupling: {{k: 1, force: k*s{'+0' * 300}}}"
    ),
    "name: ... letters, digits": lambda path: path.write_text(SCENE.replace(" a", " " + 65 * "x")),
}


@pytest.mark.parametrize("says", UNREADABLE)
def test_what_is_no_readable_scene_is_one_line_that_names_it_and_nothing_is_written(says, tmp_path, capsys):
    path = tmp_path / "scene.yaml"
    UNREADABLE[says](path)
    before = tree(tmp_path)
    line = refusal(["run", path, "-o", tmp_path / "out"], capsys)
    assert line.startswith(f"{path}: ")
    assert re.search(pattern(says), line), line
    assert len(line) < len(str(path)) + 250
    assert tree(tmp_path) == before


@pytest.mark.parametrize("words", ["analyze", "run two-chains -o", "deck two-chains -o"])
def test_a_name_that_is_too_long_is_one_line(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert "File name too long" in refusal([*words.split(), "x" * 300], capsys)
