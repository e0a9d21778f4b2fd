"""The page on how to add a part: its diffs apply, and what they add works as the page says."""

import csv
import json
import os
import re
from pathlib import Path

import pytest
from core_alone import ROOT
from extending import apply, git_apply, in_turn, python, sections


@pytest.mark.parametrize("section", sections())
def test_the_diffs_of_a_section_apply_to_the_tree(section, executable):
    executable("git")
    diffs = sections()[section]
    assert diffs, "a section of this page shows its addition as a diff"
    beside = re.findall(r"^[ -].*\bplugins[./](\w+)", "".join(diffs), re.MULTILINE)  # in lines that must be there
    if missing := {name for name in beside if not (ROOT / "workflow" / "plugins" / name).is_dir()}:
        pytest.skip(f"the diff is to a tree with the plug-ins {', '.join(sorted(missing))}")
    git_apply("".join(diffs), ROOT, "--check")


ADDED = (
    "A force law",
    "An ingredient",
    "A law of contacts",
    "A measure with a parameter",
    "A quantity at a bead",
    "A study",
    "A tool",
    "An engine",
)


@pytest.fixture(scope="module")
def environment(tmp_path_factory, executable):
    """Environment of a copy of the tree with all additions, whose modules and programs are then compiled once."""
    executable("git")
    tree = tmp_path_factory.mktemp("tree")
    return [apply(section, tree) for section in ADDED][-1]


def scene(folder, name="scene", **keys):
    """Name of a scene's file in a folder; JSON is YAML."""
    plain = {"name": name, "chains": 1, "beads": 20, "kick": {"velocity": 1}, "duration": 20, **keys}
    (folder / f"{name}.yaml").write_text(json.dumps(plain), encoding="utf-8")
    return f"{name}.yaml"


def evaluated(environment, folder, quantity, *names):
    """Number that studies compute of each of some scenes in memory."""
    code = (
        "import granchain; from granchain.parts import evaluate\n"
        f"for name in {names!r}:\n"
        f"    print(evaluate.of_scene(granchain.load(name).plain(), ({quantity!r},), 'scene')[{quantity!r}])"
    )
    return [float(line) for line in python(environment, folder, "-c", code).split()]


@pytest.mark.slow
def test_a_scene_with_the_ingredient_and_the_law_of_contacts_runs_in_lammps_as_in_the_reference(environment, tmp_path):
    coupled = {"chains": 2, "coupling": {"stiffness": 0.1}, "contact": {"stiffening": 0.5}}
    stiff, soft = (scene(tmp_path, f"bed-{q}", **coupled, bed={"quintic": q}) for q in (0.2, 1e-9))
    in_turn(environment, tmp_path, ["run", stiff, "-o", "out"])
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert record["outcome"] == "done"
    assert 0.0 < record["check"]["velocity"] < record["settings"]["accuracy"]
    assert "strain^5" in (tmp_path / "out" / "in.chains").read_text()
    of_stiff, of_soft = evaluated(environment, tmp_path, "peak_velocity@10", stiff, soft)
    assert of_stiff < of_soft - 0.01  # the bed takes energy


@pytest.mark.slow
def test_the_measures_number_is_printed_written_and_computed_by_studies(environment, tmp_path):
    keys = {"damping": {"beads": 0.1}, "duration": 40}
    name, sooner = (scene(tmp_path, f"below-{limit}", output={"settling": limit}, **keys) for limit in (0.1, 0.2))
    words = ["--where", "settling_time=15", "--vary", "damping.beads=0.1:0.3", "--points", "2", "--tolerance", "0.5"]
    _, printed, found = in_turn(
        environment,
        tmp_path,
        ["run", name, "-o", "out", "--engine", "reference", "--no-check"],
        ["analyze", "out", "--no-figures"],
        ["threshold", name, *words, "-o", "found", "--json"],
    )
    assert "no bead is faster than 0.1 after" in printed
    settled = json.loads((tmp_path / "out" / "analysis.json").read_text())["settling"]
    assert settled["velocity"] == 0.1
    assert 10.0 < settled["settling_time"] < 40.0
    computed, of_sooner = evaluated(environment, tmp_path, "settling_time", name, sooner)
    assert computed == settled["settling_time"]
    assert of_sooner < settled["settling_time"] - settled["settling_time_error"]  # below a higher velocity
    [threshold] = json.loads(found)["thresholds"]
    assert 0.1 < threshold["place"] < 0.3


@pytest.mark.slow
def test_the_quantity_at_a_bead_is_a_column_of_waves_and_of_the_table_of_a_sweep(environment, tmp_path):
    name = scene(tmp_path)
    (tmp_path / "sweep.yaml").write_text(f"scene: {name}\nvary: {{kick.velocity: [1.0, 2.0]}}\nengine: reference\n")
    in_turn(
        environment,
        tmp_path,
        ["sweep", "sweep.yaml", "-o", "cases", "--jobs", "1"],
        ["collect", "cases", "--plot", "peak_energy@10", "--over", "kick.velocity"],
    )
    with (tmp_path / "cases" / "kick.velocity=1" / "waves.csv").open(newline="") as file:
        [at_bead] = [row for row in csv.DictReader(file) if row["bead"] == "10"]
    energy, velocity = float(at_bead["peak_energy"]), float(at_bead["peak_velocity"])
    assert energy == pytest.approx(0.5 * velocity**2, rel=1e-14)  # the mass is 1
    assert float(at_bead["peak_energy_error"]) == pytest.approx(velocity * float(at_bead["peak_velocity_error"]))
    with (tmp_path / "cases" / "table.csv").open(newline="") as file:
        first, second = csv.DictReader(file)
    assert float(first["peak_energy@10"]) == energy
    assert float(second["peak_energy@10"]) == pytest.approx(4.0 * energy, rel=1e-6)  # one shape at every velocity
    assert first["peak_energy"]
    assert evaluated(environment, tmp_path, "peak_energy@10", name) == [pytest.approx(energy, rel=1e-6)]


@pytest.mark.slow
def test_the_study_finds_the_exponent_of_spheres_and_stores_its_cases(environment, tmp_path):
    words = ["scaling", "one-chain", "--velocities", "2,0.5,1", "-o", "scaled"]
    printed, again = in_turn(environment, tmp_path, words, [*words, "--json"])
    rows = [line.split() for line in printed.splitlines() if line.strip()[:1].isdigit()]
    assert [row[::2] for row in rows] == [["0.5", "-"], ["1", "0.2000"], ["2", "0.2000"]]
    assert printed.endswith("written to scaled: scaling.csv\n")
    records = json.loads(again)
    assert [record["velocity"] for record in records] == [0.5, 1.0, 2.0]
    # speed ~ velocity**(1/5) is exact for contacts of exponent 3/2 without load; the rest is rounding and steps
    assert [record["exponent"] for record in records] == [None, *[pytest.approx(0.2, abs=1e-6)] * 2]
    with (tmp_path / "scaled" / "scaling.csv").open() as file:
        assert [row["speed"] for row in csv.DictReader(file)] == [str(record["speed"]) for record in records]
    assert len((tmp_path / "scaled" / "cases.jsonl").read_text().splitlines()) == 3  # none was computed again


@pytest.mark.slow
def test_the_tool_prints_the_fields_that_differ_and_no_other(environment, tmp_path):
    words = ["diff", "one-chain", "two-chains"]
    data, printed, same = in_turn(environment, tmp_path, [*words, "--json"], words, ["diff", "one-chain", "one-chain"])
    answer = json.loads(data)
    assert answer["chains"] == [1, 2]
    assert answer["coupling.stiffness"] == [None, 0.1]
    assert "beads" not in answer
    assert [line.split()[0] for line in printed.splitlines()[2:]] == list(answer)
    assert same == "the scenes have the same fields with the same values\n"


@pytest.mark.slow
def test_the_engine_computes_a_run_that_the_validation_passes(environment, tmp_path):
    springs = {"foundation": {"stiffness": 0.1}, "resonators": {"mass": 0.5, "stiffness": 0.2}}
    name = scene(tmp_path, chains=2, beads=12, coupling={"stiffness": 0.1}, duration=10, **springs)
    printed, validated, state = in_turn(
        environment,
        tmp_path,
        ["run", name, "--engine", "dop853", "-o", "run"],
        ["validate", "run", "--json"],
        ["status", "run"],
    )
    assert "Runge-Kutta" in printed
    validation = json.loads(validated)
    assert validation["passed"] is True
    # the uncertainty of the reference is some 2e-6 V
    assert validation["quantities"]["velocity"]["largest"] < 1e-5
    assert state.startswith("run: done")


@pytest.mark.slow
def test_what_an_ingredient_owes_beside_its_code_is_written_once_with_texts_to_be_filled(environment):
    tree = Path(environment["PYTHONPATH"].partition(os.pathsep)[0])
    written = python(environment, tree, "tests/support/new_ingredient.py", "bed")
    for name in ("SCENES.md", "GALLERY.md", "scenes/bed.yaml"):
        assert f"written: lammps_inputs/{name}" in written
        assert "FILL" in (tree / "lammps_inputs" / name).read_text()
    with pytest.raises(AssertionError, match=r"bed\.yaml: exists"):
        python(environment, tree, "tests/support/new_ingredient.py", "bed")
