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
MOST_NAMES = 124
"""Names of the core that all plug-ins and the template package together may take."""
BELOW = {
    "lammps_inputs": set(),
    "analysis": {"lammps_inputs"},
    "workflow": {"lammps_inputs", "analysis"},
}
LAYERS = {  # the lowest first
    "lammps_inputs": ("laws", "ingredients", "formulas", "limits", "decks"),
    "analysis": ("files", "shape", "tracking", "mda", "compare", "sharing", "gauges", "figures"),
    "workflow": (
        "engines",
        "workers",
        "prepare",
        "runs",
        "measures",
        "verdicts",
        "quantities",
        "sweep",
        "study_kit",
        "interface",
        "commands",
    ),
}


@functools.cache
def imported(source: str, *, types: bool = True) -> set[str]:
    """Dotted names that a source imports anywhere in it, ``.`` for a relative import; without what only types need."""
    found: set[str] = set()
    waiting: list[ast.AST] = [ast.parse(source)]
    while waiting:
        node = waiting.pop()
        if not types and isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            waiting += node.orelse
            continue
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


@pytest.mark.parametrize(
    ("package", "source", "found"),
    [
        ("lammps_inputs", "import analysis", "analysis"),
        ("lammps_inputs", "import numpy, workflow.cli as cli", "workflow"),
        ("lammps_inputs", "from analysis.trajectory import Trajectory", "analysis"),
        ("analysis", "def late():\n    from workflow import engines", "workflow"),
        ("analysis", "if TYPE_CHECKING:\n    import workflow.engines", "workflow"),
        ("workflow", "def late():\n    import granchain", "granchain"),
        ("workflow", "from . import engines", "."),
        ("analysis", "from lammps_inputs import Scene\nimport numpy", None),
        ("lammps_inputs", "from lammps_inputs.numbers import text  # not analysis", None),
    ],
)
def test_the_walk_finds_an_import_that_breaks_the_rule_and_no_other(package, source, found):
    assert violations(package, source) == ({found} if found else set())


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
    assert of_face == set(lazy_names.sources(parts.__file__))


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("from granchain.parts import Trajectory", {"granchain.parts.Trajectory"}),
        ("def late():\n    from analysis.motion import energy", {"analysis.motion.energy"}),
        ("from workflow.plugins.modes import family\nimport numpy", set()),
    ],
)
def test_the_walk_finds_what_a_plug_in_takes_of_the_core(source, found):
    assert taken(source) == found


# --- within a package -------------------------------------------------------------------------------------------------


def within(source: str, package: str) -> set[str]:
    """Subpackages and modules of a package that a source imports where it runs."""
    parts = [name.split(".") for name in imported(source, types=False)]
    return {part[1] for part in parts if part[0] == package and len(part) > 1}


def imports_of(package: str, place: str) -> set[str]:
    """What a subpackage, or a module beside them, imports of its own package, without itself."""
    folder = ROOT / package / place
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [folder.with_suffix(".py")]
    return set().union(*(within(file.read_text(encoding="utf-8"), package) for file in files)) - {place}


@pytest.mark.parametrize(
    ("package", "subpackage"),
    [(package, subpackage) for package, subpackages in LAYERS.items() for subpackage in subpackages],
)
def test_a_subpackage_imports_none_above_it(package, subpackage):
    layers = LAYERS[package]
    assert imports_of(package, subpackage) & set(layers[layers.index(subpackage) :]) == set()


@pytest.mark.parametrize("package", LAYERS)
def test_subpackages_and_modules_import_one_another_in_no_circle(package):
    loose = [path.stem for path in (ROOT / package).glob("*.py") if path.stem != "__init__"]
    places = {*loose, *LAYERS[package]}
    TopologicalSorter({place: imports_of(package, place) & places for place in places}).prepare()


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


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("if TYPE_CHECKING:\n    from workflow.runs.run import run", "workflow.runs.run"),
        ("def late():\n    from workflow.runs import run", "workflow.runs.run"),
    ],
)
def test_the_walk_over_modules_sees_imports_for_types_and_within_functions(source, name):
    assert modules_imported(source, {"workflow.runs", "workflow.runs.run"}) == {name}


@pytest.mark.parametrize("package", LAYERS)
def test_every_folder_of_a_package_is_listed_and_has_a_docstring(package):
    folders = {path.name for path in (ROOT / package).iterdir() if any(path.glob("*.py"))}
    assert folders - {"plugins"} == set(LAYERS[package])
    for subpackage in folders:
        assert ast.get_docstring(ast.parse((ROOT / package / subpackage / "__init__.py").read_text(encoding="utf-8")))


@pytest.mark.parametrize("package", LAYERS)
def test_the_developer_guide_of_a_package_names_its_subpackages_and_modules(package):
    text = (ROOT / package / "DEVELOPING.md").read_text(encoding="utf-8")
    modules = [path.name for path in (ROOT / package).glob("*.py") if path.stem != "__init__"]
    assert [name for name in (*LAYERS[package], *modules) if f"`{name}`" not in text] == []


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("from workflow import sweep", {"sweep"}),
        ("def late():\n    import workflow.runs.run", {"runs"}),
        ("from workflow.sweep.collect import rows", {"sweep"}),
        ("if TYPE_CHECKING:\n    import workflow.runs.run", set()),
        ("import analysis.files, workflow", set()),
    ],
)
def test_the_walk_finds_what_is_imported_within_a_package(source, found):
    assert within(source, "workflow") == found


def test_the_developer_guide_follows_a_scene_by_functions_that_exist():
    text = (ROOT / "workflow" / "DEVELOPING.md").read_text(encoding="utf-8")
    section = text.partition("## From a scene to waves.csv")[2].partition("\n## ")[0]
    names = re.findall(r"`((?:lammps_inputs|analysis|workflow)\.[\w.]*[a-z_]+\.\w+)`", section)
    assert len(names) >= 14
    for name in names:
        assert pkgutil.resolve_name(name), name
