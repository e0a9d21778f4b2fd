"""Follows a page of the manual as its reader does: saves its files, types its commands, compares their output.

A block whose first line is ``# NAME.EXTENSION`` is a file. A block of ``sh`` is typed; lines of nothing but granchain
are done in this process, which saves starting others, unless the page exports variables. What is indented below is
the output, line by line in this order; ``...`` stands for anything, and numbers may differ by two per cent.
"""

import contextlib
import io
import math
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from processes import HANGS

from workflow.cli import main

TOLERANCE = 0.02
"""Of quoted numbers, relative: other releases of LAMMPS and other processors round differently."""

_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$|^((?: {4}[^\n]*\n)+)", re.M | re.S)
_NAME = re.compile(r"# ([\w.-]+\.\w+)\n")
_OURS = re.compile(r"granchain [^&|<>;$]*(&& granchain [^&|<>;$]*)*")
_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


_STUDY = re.compile(r"^granchain (design|extremes|fit|gallery|lyapunov|modes|threshold|trade)\b", re.M)


def types_studies(page: str) -> bool:
    """Whether a page, or a section of one, types a command of a study: it is then followed with their tests."""
    return any(kind == "sh" and _STUDY.search(content) for kind, content, _ in _BLOCK.findall(page))


def sections(page: str) -> list[str]:
    """A page cut before each of its headings of the second level."""
    return re.split(r"^(?=## )", page, flags=re.M)


def environment(more: Mapping[str, str]) -> dict[str, str]:
    """Variables of this process, and more; first in the path are the programs of this Python."""
    variables = {**os.environ, **more}
    return {**variables, "PATH": f"{Path(sys.executable).parent}:{variables['PATH']}"}


def follow(page: str, folder: Path, environment: Mapping[str, str]) -> None:
    """Do what a page says.

    Raises:
        AssertionError: a command failed, or its output is not the quoted one.
    """
    output = ""
    for kind, content, quoted in _BLOCK.findall(page):
        if quoted:
            compare(quoted, output)
        elif kind == "sh":
            output = ""
            for line in content.splitlines():
                ours = _OURS.fullmatch(line) and "\nexport " not in page
                output += called(line, folder) if ours else typed(line, folder, environment)
        elif name := _NAME.match(content):
            (folder / name[1]).write_text(content, encoding="utf-8")


def called(line: str, folder: Path) -> str:
    """Output of a line of commands of granchain."""
    output = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        for command in line.split("&&"):
            words, _, code = command.partition("# exit code ")
            assert main(shlex.split(words)[1:]) == int(code or 0), output.getvalue()
    return output.getvalue()


def typed(commands: str, folder: Path, environment: Mapping[str, str]) -> str:
    """Output of commands in a shell that knows what earlier ones exported.

    All succeed but those that end in ``# exit code N``.
    """
    lines = re.sub(r"^(.*)# exit code (\d)$", r"code=0; \1|| code=$?; [ $code = \2 ]", commands, flags=re.M)
    script = f"set -eo pipefail\n[ ! -e .exported ] || . ./.exported\n{lines}\nexport -p >.exported"
    done = subprocess.run(
        ["bash", "-c", script], cwd=folder, env=environment, capture_output=True, text=True, timeout=HANGS, check=False
    )
    assert done.returncode == 0, f"{commands}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def compare(quoted: str, output: str) -> None:
    """Find each quoted line in the output, below the one before.

    Raises:
        AssertionError: one is not there.
    """
    lines = iter(output.splitlines())
    for wanted in filter(None, (" ".join(line.split()) for line in quoted.splitlines())):
        if wanted != "...":
            assert any(_same(wanted, line) for line in lines), f"not found (in this order): {wanted}\n{output}"


def _same(wanted: str, line: str) -> bool:
    parts = re.split(rf"({_NUMBER}|\.\.\.)", wanted)
    pattern = "".join(
        re.escape(part) if place % 2 == 0 else ".*" if part == "..." else f"({_NUMBER})"
        for place, part in enumerate(parts)
    )
    found = re.fullmatch(pattern, " ".join(line.split()))
    numbers = [part for part in parts[1::2] if part != "..."]
    return found is not None and all(
        math.isclose(float(one), float(other), rel_tol=TOLERANCE)
        for one, other in zip(found.groups(), numbers, strict=True)
    )
