"""The page on how to add a part: its diffs apply, and what they add works as the page says."""

import csv
import json
import re
from pathlib import Path
from typing import Any

import pytest
from core_alone import ROOT
from extending import apply, git_apply, granchain, python, sections


@pytest.mark.parametrize("section", sections())
def test_the_diffs_of_a_section_apply_to_the_tree(section: str, executable: Any) -> None:
    executable("git")
    diffs = sections()[section]
    assert diffs, "a section of this page shows its addition as a diff"
    beside = re.findall(r"^[ -].*\bplugins[./](\w+)", "".join(diffs), re.MULTILINE)  # in lines that must be there
    if missing := {name for name in beside if not (ROOT / "workflow" / "plugins" / name).is_dir()}:
        pytest.skip(f"the diff is to a tree with the plug-ins {', '.join(sorted(missing))}")
    git_apply("".join(diffs), ROOT, "--check")


def scene(folder: Path, **keys: Any) -> str:
    """Name of a scene's file in a folder; JSON is YAML."""
    plain = {"name": "scene", "chains": 1, "beads": 20, "kick": {"velocity": 1}, "duration": 20, **keys}
    (folder / "scene.yaml").write_text(json.dumps(plain), encoding="utf-8")
    return "scene.yaml"


def evaluated(environment: dict[str, str], folder: Path, name: str, quantity: str) -> float:
    """Number that studies compute of a scene in memory."""
    code = (
        "import granchain; from granchain.parts import evaluate; "
        f"print(evaluate.of_scene(granchain.load({name!r}).plain(), ({quantity!r},), 'scene')[{quantity!r}])"
    )
    return float(python(environment, folder, "-c", code))


@pytest.fixture
def folder(tmp_path: Path, executable: Any) -> Path:
    """Empty folder beside the copy of the tree."""
    executable("git")
    (tmp_path / "used").mkdir()
    return tmp_path / "used"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Directory of the copy of the tree."""
    (tmp_path / "tree").mkdir()
    return tmp_path / "tree"


@pytest.mark.slow
def test_the_functions_of_the_law_are_slopes_and_inverses_of_each_other(folder: Path, tree: Path) -> None:
    code = """
from workflow.plugins.bed.law import Quintic as law
for s in (-1.5, 0.3, 2.0):
    slope = (law.energy(s + 1e-5, 0.7) - law.energy(s - 1e-5, 0.7)) / 2e-5
    assert abs(slope - law.force(s, 0.7)) < 1e-7, s  # the third derivative is at most 20 * 0.7 * 2**3: error 2e-9
    slope = (law.force(s + 1e-5, 0.7) - law.force(s - 1e-5, 0.7)) / 2e-5
    assert abs(slope - law.stiffness(s, 0.7)) < 1e-7, s
    assert abs(law.max_strain(law.energy(s, 0.7), 0.7) - abs(s)) < 1e-14 * 10
"""
    python(apply("A force law", tree), folder, "-c", code)


@pytest.mark.slow
def test_a_scene_with_the_ingredient_runs_in_lammps_as_in_the_reference(folder: Path, tree: Path) -> None:
    apply("A force law", tree)
    environment = apply("An ingredient", tree)
    name = scene(folder, chains=2, coupling={"stiffness": 0.1}, bed={"quintic": 0.2})
    granchain(environment, folder, "run", name, "-o", "out")
    record = json.loads((folder / "out" / "run.json").read_text())
    assert record["outcome"] == "done"
    assert 0.0 < record["check"]["velocity"] < record["settings"]["accuracy"]
    assert "strain^5" in (folder / "out" / "in.chains").read_text()
    with_bed = evaluated(environment, folder, name, "peak_velocity@10")
    name = scene(folder, chains=2, coupling={"stiffness": 0.1})
    assert with_bed < evaluated(environment, folder, name, "peak_velocity@10") - 0.01  # the bed takes energy


@pytest.mark.slow
def test_the_measures_number_is_printed_written_and_computed_by_studies(folder: Path, tree: Path) -> None:
    environment = apply("A measure with a parameter", tree)
    keys = {"damping": {"contact": 0.1, "beads": 0.1}, "duration": 40}
    name = scene(folder, output={"settling": 0.1}, **keys)
    granchain(environment, folder, "run", name, "-o", "out", "--engine", "reference", "--no-check")
    assert "no bead is faster than 0.1 after" in granchain(environment, folder, "analyze", "out", "--no-figures")
    settled = json.loads(granchain(environment, folder, "analyze", "out", "--no-figures", "--json"))["settling"]
    assert settled["velocity"] == 0.1
    assert 10.0 < settled["settling_time"] < 40.0
    assert evaluated(environment, folder, name, "settling_time") == settled["settling_time"]
    slower = evaluated(environment, folder, scene(folder, output={"settling": 0.2}, **keys), "settling_time")
    assert slower < settled["settling_time"] - settled["settling_time_error"]  # sooner below a higher velocity
    words = ("--where", "settling_time=15", "--vary", "damping.beads=0.1:0.3", "--points", 2, "--tolerance", 0.5)
    scene(folder, output={"settling": 0.1}, **keys)
    found = granchain(environment, folder, "threshold", name, *words, "-o", "found", "--json")
    [threshold] = json.loads(found)["thresholds"]
    assert 0.1 < threshold["place"] < 0.3


@pytest.mark.slow
def test_a_law_of_contacts_is_a_key_of_contacts_with_walls_and_strengths(folder: Path, tree: Path) -> None:
    environment = apply("A law of contacts", tree)
    name = scene(folder, contact={"stiffening": 0.5, "strength": [1, 2] * 9 + [1]}, walls={"right": "bead"})
    granchain(environment, folder, "run", name, "-o", "out", "--engine", "reference")
    assert "$defs" in (schema := json.loads(granchain(environment, folder, "schema")))
    assert "stiffening" in schema["$defs"]["StiffeningContact"]["properties"]


@pytest.mark.slow
def test_the_quantity_at_a_bead_is_a_column_of_waves_and_of_the_table_of_a_sweep(folder: Path, tree: Path) -> None:
    environment = apply("A quantity at a bead", tree)
    name = scene(folder)
    (folder / "sweep.yaml").write_text(f"scene: {name}\nvary: {{kick.velocity: [1.0, 2.0]}}\nengine: reference\n")
    granchain(environment, folder, "sweep", "sweep.yaml", "-o", "cases")
    granchain(environment, folder, "collect", "cases", "--plot", "peak_energy@10", "--over", "kick.velocity")
    with (folder / "cases" / "kick.velocity=1" / "waves.csv").open(newline="") as file:
        [at_bead] = [row for row in csv.DictReader(file) if row["bead"] == "10"]
    energy, velocity = float(at_bead["peak_energy"]), float(at_bead["peak_velocity"])
    assert energy == pytest.approx(0.5 * velocity**2, rel=1e-14)  # the mass is 1
    assert float(at_bead["peak_energy_error"]) == pytest.approx(velocity * float(at_bead["peak_velocity_error"]))
    with (folder / "cases" / "table.csv").open(newline="") as file:
        first, second = csv.DictReader(file)
    assert float(first["peak_energy@10"]) == energy
    assert float(second["peak_energy@10"]) == pytest.approx(4.0 * energy, rel=1e-6)  # one shape at every velocity
    assert first["peak_energy"]
    assert evaluated(environment, folder, name, "peak_energy@10") == pytest.approx(energy, rel=1e-6)
