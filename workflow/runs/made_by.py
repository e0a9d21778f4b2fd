"""Directories of the commands that make many runs, or none: how each is recognised, and whether it is whole.

Such a directory is told by files that only its command writes, of which one is written at the end.
"""

import json
import shlex
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from lammps_inputs import file_names


@dataclass(frozen=True)
class Made:
    """A directory that a command other than ``run`` has made.

    Attributes:
        command: its name.
        whole: whether it came to its end.
        why: what the directory holds, or what to do next.
    """

    command: str
    whole: bool
    why: str


@dataclass(frozen=True)
class _Kind:
    """How a command's directory is told.

    Attributes:
        begun: whether it is one.
        ended: whether such a one is whole.
        result: where to look, once it is.
        onwards: what to do otherwise, for a directory.
    """

    begun: Callable[[Path], bool]
    ended: Callable[[Path], bool]
    result: str
    onwards: str


def made_by(directory: Path) -> Made | None:
    """Which command made a directory; None for a run, a sweep, and everything else."""
    for command, kind in _KINDS.items():
        if kind.begun(directory):
            whole = kind.ended(directory)
            why = kind.result if whole else kind.onwards.format(shlex.quote(str(directory)))
            return Made(command, whole, f"of `granchain {command}`; {why}")
    return None


def _has(name: str) -> Callable[[Path], bool]:
    return lambda directory: (directory / name).is_file()


def _holds(pattern: str) -> Callable[[Path], bool]:
    return lambda directory: any(directory.glob(pattern))


def _compares(directory: Path) -> bool:
    """Whether an engine's run stands in it, and no run of its own."""
    if not _has(file_names.SCENE)(directory) or _has(file_names.DECK)(directory):
        return False
    return any(_has(file_names.SCENE)(directory / engine) for engine in ("lammps", "reference", "collisions"))


def _trades(directory: Path) -> bool:
    try:
        with (directory / "trade.csv").open("rb") as file:
            return file.read(7) == b"method,"
    except OSError:
        return False


def _traded(directory: Path) -> bool:
    try:
        found = json.loads((directory / "trade.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(found, dict) and found.get("whole") is True


_KINDS = {
    "compare": _Kind(
        _compares,
        _has("compare.json"),
        "compare.json says what was found, and each engine's run has a directory in it",
        "not every engine came to its end; the same command with another -o makes it anew",
    ),
    "reproduce": _Kind(
        _holds(f"runs/*/{file_names.SCENE}"),
        _has("index.html"),
        "index.html is the report",
        "`granchain reproduce -o {}` goes on",
    ),
    "gallery": _Kind(
        _holds(f"entries/*/runs/*/{file_names.SCENE}"),
        _has("index.html"),
        "index.html is the page",
        "`granchain gallery -o {}` goes on",
    ),
    "map": _Kind(
        _holds("cases/N*_kappa*.json"), _has("map.csv"), "map.csv is the table", "`granchain map -o {}` goes on"
    ),
    "extremes": _Kind(
        _holds("cells/*.json"),
        _has("extremes.csv"),
        "extremes.csv is the table",
        "`granchain extremes -o {}` goes on",
    ),
    "fit": _Kind(
        _has("fitted.yaml"), _has("fit.json"), "fit.json says what was found", "the same command makes it anew"
    ),
    "design": _Kind(
        _has("evaluations.jsonl"),
        _has("index.html"),
        "index.html is the report",
        "the same `granchain design DESIGN.yaml -o {}` goes on",
    ),
    "trade": _Kind(
        _trades,
        _traded,
        "trade.json says what was found",
        "its tables hold what was measured; the same command with another -o measures anew",
    ),
}
