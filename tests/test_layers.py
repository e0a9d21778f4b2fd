"""Imports run one way: between packages, ``lammps_inputs <- analysis <- workflow``, and between those within each."""

import ast
import functools
import pkgutil
import re
from graphlib import TopologicalSorter
from pathlib import Path

import plug_ins
import pytest

from granchain import parts
from workflow import lazy_names

ROOT = Path(__file__).parents[1]
PLUG_INS = ROOT / "workflow" / "plugins"
FACES = ("granchain", "granchain.parts")
OF_LAWS = {"DeckLines", "FurtherAtoms"}
"""Names for laws and ingredients of other distributions."""
MOST_NAMES = 124
"""Names of the core that all plug-ins and the template package together may take."""
BELOW = {
    "lammps_inputs": set(),
    "analysis": {"lammps_inputs"},
    "workflow": {"lammps_inputs", "analysis"},
}


@functools.cache
def imported(source: str) -> set[str]:
    """Dotted names that a source imports anywhere in it, ``.`` for a relative import."""
    found: set[str] = set()
    waiting: list[ast.AST] = [ast.parse(source)]
    while waiting:
        node = waiting.pop()
        waiting += (child for child in ast.iter_child_nodes(node) if not isinstance(child, ast.expr))
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {"." if node.level else f"{node.module}.{alias.name}" for alias in node.names}
    return found


# --- packages ---------------------------------------------------------------------------------------------------------


def violations(package: str, source: str) -> set[str]:
    """What a source of a package imports from its own project and must not."""
    found = {name.partition(".")[0] or "." for name in imported(source)}
    return found & (set(BELOW) | {".", "tests", "granchain"}) - BELOW[package] - {package}


@pytest.mark.parametrize("package", BELOW)
def test_modules_of_a_package_import_only_it_and_those_below(package):
    paths = [path for path in (ROOT / package).rglob("*.py") if path.parts[-3:-1] != ("python", "granchain")]
    core = [path for path in paths if not path.is_relative_to(PLUG_INS)]
    found = {path: violations(package, path.read_text(encoding="utf-8")) for path in core}
    assert {path: names for path, names in found.items() if names} == {}
    assert len(found) > 1


def test_the_core_imports_no_plug_in():
    sources = [path for package in BELOW for path in (ROOT / package).rglob("*.py")]
    core = [path for path in sources if ROOT / "workflow" / "plugins" not in path.parents]
    assert len(core) > 100
    found = {path: " ".join(imported(path.read_text(encoding="utf-8"))) for path in core}
    assert [path for path, names in found.items() if "workflow.plugins." in names] == []


# --- plug-ins ---------------------------------------------------------------------------------------------------------


def taken(source: str) -> set[str]:
    """Dotted names of the project that a source of a plug-in imports, but those of plug-ins."""
    ours = (*BELOW, "tests", "granchain", ".")
    names = {name for name in imported(source) if name.partition(".")[0] in ours or name == "."}
    return {name for name in names if not name.startswith("workflow.plugins.")}


def test_plug_ins_take_names_of_the_core_from_two_modules_and_not_too_many():
    template = ROOT / "tests" / "support" / "template_package"
    sources = [*PLUG_INS.rglob("*.py"), *template.rglob("*.py")]
    names = set().union(*(taken(path.read_text(encoding="utf-8")) for path in sources))
    assert len(names) <= MOST_NAMES
    assert {name for name in names if name.rpartition(".")[0] not in FACES} == set()
    of_face = {name.rpartition(".")[2] for name in names if name.startswith("granchain.parts.")}
    assert of_face <= set(lazy_names.sources(parts.__file__))
    plug_ins.skip_if_deleted(*plug_ins.WITHOUT)  # whose names nothing takes
    assert of_face | OF_LAWS == set(lazy_names.sources(parts.__file__))


# --- modules ----------------------------------------------------------------------------------------------------------


def modules_imported(source: str, known: set[str]) -> set[str]:
    """Modules of the product that a source imports anywhere in it, for type checkers and within functions included."""
    return {name if name in known else name.rpartition(".")[0] for name in imported(source)} & known


def test_no_module_is_on_a_circle_of_imports():
    paths = [path for package in BELOW for path in (ROOT / package).rglob("*.py")]
    names = {".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path for path in paths}
    graph = {
        name: modules_imported(path.read_text(encoding="utf-8"), set(names)) - {name} for name, path in names.items()
    }
    assert len(graph) > 100
    TopologicalSorter(graph).prepare()


def test_the_developer_guide_follows_a_scene_by_functions_that_exist():
    text = (ROOT / "workflow" / "DEVELOPING.md").read_text(encoding="utf-8")
    section = text.partition("## From a scene to waves.csv")[2].partition("\n## ")[0]
    names = re.findall(r"`((?:lammps_inputs|analysis|workflow)\.[\w.]*[a-z_]+\.\w+)`", section)
    assert len(names) >= 14
    for name in names:
        assert pkgutil.resolve_name(name), name
