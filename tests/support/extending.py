"""Additions that a section of the page on how to add a part shows as diffs, in a copy of the tree."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from core_alone import ROOT, copy_without
from executables import path_of
from processes import HANGS
from tree_metadata import write_metadata

PAGE = ROOT / "workflow" / "EXTENDING.md"


def sections() -> dict[str, list[str]]:
    """Title of each section of the page -> its diffs, in the form that `git apply` takes."""
    _, *texts = re.split(r"^## (.*)\n", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    pairs = zip(texts[::2], texts[1::2], strict=True)
    return {name: re.findall(r"^```diff\n(.*?)^```$", text, re.MULTILINE | re.DOTALL) for name, text in pairs}


def git_apply(diff: str, tree: Path, *options: str) -> None:
    """Apply a diff to a tree; a failed one fails with git's message."""
    outside = {**os.environ, "GIT_CEILING_DIRECTORIES": str(tree.parent)}  # paths are those of the diff
    words = [path_of("git"), "apply", *options, "-"]
    answer = subprocess.run(words, cwd=tree, env=outside, input=diff, capture_output=True, text=True)
    assert answer.returncode == 0, f"{answer.stderr}\n{diff}"


def apply(section: str, tmp_path: Path) -> dict[str, str]:
    """Apply the diffs of a section to a copy of the tree in a directory, or to the copy that is there already.

    Args:
        section: title of the section.
        tmp_path: directory of the copy.

    Returns:
        Environment in which ``python -P -m workflow`` is that of the copy, with its entry points.
    """
    if not (tmp_path / "pyproject.toml").exists():
        copy_without(set(), tmp_path)
    diffs = sections()[section]
    assert diffs, f"{section} shows no diff"
    for diff in diffs:
        git_apply(diff, tmp_path)
    write_metadata(tmp_path / "pyproject.toml", tmp_path)
    path = os.pathsep.join(map(str, (tmp_path, tmp_path / "workflow/python", tmp_path / "tests/support")))
    return {**os.environ, "PYTHONPATH": path}


def python(environment: dict[str, str], directory: Path, *words: object) -> str:
    """Standard output of Python with these words, in a directory; it must end with exit code 0."""
    command = [sys.executable, "-P", *map(str, words)]
    answer = subprocess.run(
        command, cwd=directory, env=environment, capture_output=True, text=True, timeout=HANGS, check=False
    )
    assert answer.returncode == 0, f"{answer.stdout}\n{answer.stderr}"
    return answer.stdout


def granchain(environment: dict[str, str], directory: Path, *words: object) -> str:
    """Standard output of the command of the copy."""
    return python(environment, directory, "-m", "workflow", *words)


IN_TURN = """
import json, sys
from workflow.cli import main
for words in json.loads(sys.argv[1]):
    assert main(words) == 0
    print(end=chr(0))
"""


def in_turn(environment: dict[str, str], directory: Path, *commands: Sequence[str]) -> list[str]:
    """Standard output of each of some commands of the copy, by one process: each takes seconds to start."""
    return python(environment, directory, "-c", IN_TURN, json.dumps(commands)).split("\0")[:-1]
