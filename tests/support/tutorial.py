"""Follows a page of the manual as its reader does: saves its files, types its commands, compares their output.

A block whose first line is ``# NAME.EXTENSION`` is a file. A block of ``sh`` is typed. What is indented below is its
output, line by line in this order; ``...`` stands for anything, and numbers may differ by two per cent.
"""

import math
import re
import subprocess
from collections.abc import Mapping
from pathlib import Path

from processes import HANGS

TOLERANCE = 0.02
"""Of quoted numbers, relative: other releases of LAMMPS and other processors round differently."""

_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$|^((?: {4}[^\n]*\n)+)", re.M | re.S)
_NAME = re.compile(r"# ([\w.-]+\.\w+)\n")
_NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


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
            output = typed(content, folder, environment)
        elif name := _NAME.match(content):
            (folder / name[1]).write_text(content, encoding="utf-8")


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
