"""Imports run one way, ``lammps_inputs <- analysis <- workflow``."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BELOW = {
    "lammps_inputs": set(),
    "analysis": {"lammps_inputs"},
    "workflow": {"lammps_inputs", "analysis"},
}
FILES = [path for floor in BELOW for path in sorted((ROOT / floor).rglob("*.py"))]


def imported(source: str) -> set[str]:
    """Top-level packages that a source imports anywhere in it; ``.`` for a relative import."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add("." if node.level else str(node.module).partition(".")[0])
    return found


def violations(floor: str, source: str) -> set[str]:
    """What a source of a floor imports from its own project and must not."""
    return imported(source) & (set(BELOW) | {".", "tests"}) - BELOW[floor] - {floor}


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_module_imports_only_its_own_floor_and_those_below(path):
    floor = path.relative_to(ROOT).parts[0]
    assert violations(floor, path.read_text(encoding="utf-8")) == set()


def test_every_floor_has_modules_to_walk():
    assert {path.relative_to(ROOT).parts[0] for path in FILES} == set(BELOW)


@pytest.mark.parametrize(
    ("floor", "source", "found"),
    [
        ("lammps_inputs", "import analysis", "analysis"),
        ("lammps_inputs", "import numpy, workflow.cli as cli", "workflow"),
        ("lammps_inputs", "from analysis.trajectory import Trajectory", "analysis"),
        ("analysis", "def late():\n    from workflow import engines", "workflow"),
        ("analysis", "if TYPE_CHECKING:\n    import workflow.engines", "workflow"),
        ("workflow", "from . import engines", "."),
    ],
)
def test_the_walk_finds_an_import_that_breaks_the_rule(floor, source, found):
    assert violations(floor, source) == {found}


@pytest.mark.parametrize(
    ("floor", "source"),
    [
        ("analysis", "from lammps_inputs import Scene\nimport numpy"),
        ("workflow", "import analysis.trajectory, lammps_inputs"),
        ("lammps_inputs", "from lammps_inputs.numbers import text  # not analysis"),
    ],
)
def test_the_walk_allows_an_import_that_keeps_the_rule(floor, source):
    assert violations(floor, source) == set()
