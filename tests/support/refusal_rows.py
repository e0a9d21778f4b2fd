"""Command lines and files that are refused, as data: ``tests/refusals/*.yaml``, ``tests/plugins/*/refusals.yaml``.

Such a file maps titles to parts::

    pushes:
      files: {scene.yaml: {name: a, beads: 9, duration: 5, push: {peak: 1, duration: 2, shape: half-sine}}}
      rows:
      - {push: {peak: 0, duration: 2, shape: half-sine}, says: "push: peak: a push needs a force"}
      - {window: 64, says: "push: a window would take the bead"}

A part has ``files``, name -> content as text or as a mapping (``null`` for a file of ``before`` that is removed);
``line``, the command line without the name of the program (``run scene.yaml -o out`` where it is missing); ``before``,
command lines that prepare the directory, such as those that make a run; and ``rows``.

A row has changes of the first file (``null`` takes a key out), or ``text`` for all of it, and ``says``: how the line
begins, after the name of the first file where the row changes that. ``...`` in it stands for any words; at its start it
leaves that name open, too. A row may have ``files`` beside those of its part, another ``line``, or ``options`` at the
end of it; a row or a part may have the exit ``code``, where it is not 2, and ``slow: true``.
"""

import re
import shlex
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from refusals import refusal, tree

from lammps_inputs import strict_yaml

TESTS = Path(__file__).parents[1]

OF_A_ROW = ("says", "line", "options", "text", "files", "code", "slow")
"""Keys of a row that are no changes of its first file."""


@dataclass(frozen=True)
class Part:
    """Rows of one kind, with what they share; attributes as in a file."""

    rows: list[dict[str, Any]]
    files: dict[str, Any] = field(default_factory=dict)
    line: str = "run scene.yaml -o out"
    before: list[str] = field(default_factory=list)
    code: int = 2
    slow: bool = False


def cases() -> list[Any]:
    """Every row of the tree with its part, as parameters of a test."""
    found = []
    for path in sorted((*TESTS.glob("refusals/*.yaml"), *TESTS.glob("plugins/*/refusals.yaml"))):
        place = path.parent.name if path.name == "refusals.yaml" else path.stem
        for title, keys in strict_yaml.load(path).items():
            part = Part(**keys)
            for row in part.rows:
                marks = [pytest.mark.slow] if row.get("slow", part.slow) else []
                found.append(pytest.param(part, row, id=f"{place}: {title}: {row['says']}", marks=marks))
    return found


def pattern(says: str) -> str:
    """Regular expression of words with ``...`` for any others."""
    return ".*".join(re.escape(words.strip()) for words in says.split("..."))


def written(files: Mapping[str, Any]) -> None:
    """Write files, text or mappings, into the present directory, and remove those of None."""
    for name, content in files.items():
        if content is None:
            Path(name).unlink()
        else:
            Path(name).parent.mkdir(parents=True, exist_ok=True)
            text = content if isinstance(content, str) else strict_yaml.dump(content)
            Path(name).write_text(text, encoding="utf-8")


def assert_refused(
    part: Part, row: dict[str, Any], prepared: Callable[[Part], Path | None], capsys: pytest.CaptureFixture[str]
) -> None:
    """The command line of a row, typed in the present directory, ends as it must, and writes nothing."""
    changes = {key: value for key, value in row.items() if key not in OF_A_ROW}
    first, files = next(iter(part.files), ""), {**part.files, **row.get("files", {})}
    if "text" in row:
        files[first] = row["text"]
    elif changes:
        files[first] = {key: value for key, value in {**files[first], **changes}.items() if value is not None}
    if part.before:
        shutil.copytree(prepared(part), ".", dirs_exist_ok=True)
    written(files)
    before = tree(Path())
    words = shlex.split(row.get("line", part.line)) + shlex.split(row.get("options", ""))
    line = refusal(words, capsys, row.get("code", part.code))
    assert tree(Path()) == before
    says = row["says"]
    if changes or "text" in row:
        assert line.startswith(f"{first}: ") or says.startswith("...")
        line = line.removeprefix(f"{first}: ")
    assert re.match(pattern(says), line), line
    assert len(line) <= len(says) + 250 or first != "scene.yaml"  # others may list all quantities
