"""The rooms of each package form a staircase: none imports a room that stands above it."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
STAIRS = {  # the lowest first
    "lammps_inputs": ("laws", "ingredients", "limits", "output", "decks", "slurm"),
    "analysis": ("files", "shape", "tracking", "mda", "against", "sharing", "sound", "gauges", "figures"),
    "workflow": (
        "engines",
        "workers",
        "cluster",
        "prepare",
        "runs",
        "verdicts",
        "sweep",
        "view",
        "studies",
        "commands",
    ),
}
ROOMS = [(package, room) for package, stairs in STAIRS.items() for room in stairs]


def imported(source: str, package: str) -> set[str]:
    """Rooms and loose modules of a package that a source imports where it runs; what only types need is left out."""
    found = set()
    waiting: list[ast.AST] = [ast.parse(source)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            waiting += node.orelse
            continue
        waiting += ast.iter_child_nodes(node)
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        parts = [name.split(".") for name in names]
        found |= {part[1] for part in parts if part[0] == package and len(part) > 1}
    return found


def imports_of(package: str, place: str) -> set[str]:
    """What a room, or a loose module, of a package imports of its own package, without itself."""
    folder = ROOT / package / place
    files = sorted(folder.rglob("*.py")) if folder.is_dir() else [folder.with_suffix(".py")]
    return set().union(*(imported(file.read_text(encoding="utf-8"), package) for file in files)) - {place}


@pytest.mark.parametrize(("package", "room"), ROOMS)
def test_a_room_imports_no_room_above_it(package, room):
    stairs = STAIRS[package]
    assert imports_of(package, room) & set(stairs[stairs.index(room) :]) == set()


@pytest.mark.parametrize("package", STAIRS)
def test_rooms_and_loose_modules_stand_in_no_circle(package):
    loose = [path.stem for path in (ROOT / package).glob("*.py") if path.stem != "__init__"]
    places = {*loose, *STAIRS[package]}
    TopologicalSorter({place: imports_of(package, place) & places for place in places}).prepare()


@pytest.mark.parametrize("package", STAIRS)
def test_every_folder_of_a_package_is_a_room_that_says_what_lives_in_it(package):
    folders = {path.name for path in (ROOT / package).iterdir() if any(path.glob("*.py"))}
    assert folders == set(STAIRS[package])
    for room in folders:
        assert ast.get_docstring(ast.parse((ROOT / package / room / "__init__.py").read_text(encoding="utf-8")))


@pytest.mark.parametrize("package", STAIRS)
def test_the_readme_of_a_package_names_its_rooms_and_modules(package):
    text = (ROOT / package / "README.md").read_text(encoding="utf-8")
    modules = [path.name for path in (ROOT / package).glob("*.py") if path.stem != "__init__"]
    assert [name for name in (*STAIRS[package], *modules) if f"`{name}`" not in text] == []


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("from workflow import sweep", {"sweep"}),
        ("def late():\n    import workflow.runs.run", {"runs"}),
        ("from workflow.sweep.table import rows", {"sweep"}),
        ("if TYPE_CHECKING:\n    import workflow.runs.run", set()),
        ("import analysis.files, workflow", set()),
    ],
)
def test_the_walk_finds_what_is_imported(source, found):
    assert imported(source, "workflow") == found
