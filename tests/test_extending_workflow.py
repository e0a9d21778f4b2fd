"""The additions to `workflow` that the page on how to add a part shows work as it says."""

import csv
import json

import pytest
from extending import apply, granchain
from sweeps import SMALL

from lammps_inputs import strict_yaml

pytestmark = pytest.mark.slow


@pytest.fixture
def tree(tmp_path, executable):
    """Directory for a copy of the tree."""
    executable("git")
    return tmp_path


def scene(directory, **fields):
    """File of a small scene."""
    path = directory / "s.yaml"
    path.write_text(strict_yaml.dump({**SMALL, **fields}))
    return path


def test_the_study_finds_the_exponent_of_spheres_and_stores_its_cases(tree):
    environment = apply("A study", tree)
    words = ("scaling", "one-chain", "--velocities", "2,0.5,1", "-o", "scaled")
    printed = granchain(environment, tree, *words)
    rows = [line.split() for line in printed.splitlines() if line.strip()[:1].isdigit()]
    assert [row[::2] for row in rows] == [["0.5", "-"], ["1", "0.2000"], ["2", "0.2000"]]
    assert printed.endswith("written to scaled: scaling.csv\n")
    with (tree / "scaled" / "scaling.csv").open() as file:
        table = list(csv.DictReader(file))
    cases = (tree / "scaled" / "cases.jsonl").read_text()
    assert len(cases.splitlines()) == 3
    records = json.loads(granchain(environment, tree, *words, "--json"))
    assert [record["velocity"] for record in records] == [0.5, 1.0, 2.0]
    # speed ~ velocity**(1/5) is exact for contacts of exponent 3/2 without load; the rest is rounding and steps
    assert [record["exponent"] for record in records] == [None, *[pytest.approx(0.2, abs=1e-6)] * 2]
    assert [row["speed"] for row in table] == [str(record["speed"]) for record in records]
    assert (tree / "scaled" / "cases.jsonl").read_text() == cases


def test_the_tool_prints_the_fields_that_differ_and_no_other(tree):
    environment = apply("A tool", tree)
    answer = json.loads(granchain(environment, tree, "diff", "one-chain", "two-chains", "--json"))
    assert answer["chains"] == [1, 2]
    assert answer["coupling.stiffness"] == [None, 0.1]
    assert "beads" not in answer
    printed = granchain(environment, tree, "diff", "one-chain", "two-chains")
    assert [line.split()[0] for line in printed.splitlines()[2:]] == list(answer)
    same = granchain(environment, tree, "diff", "one-chain", "one-chain")
    assert same == "the scenes have the same fields with the same values\n"


def test_the_engine_computes_a_run_that_the_validation_passes(tree):
    environment = apply("An engine", tree)
    scene(tree, foundation={"stiffness": 0.1}, resonators={"mass": 0.5, "stiffness": 0.2})
    assert "Runge-Kutta" in granchain(environment, tree, "run", "s.yaml", "--engine", "dop853", "-o", "run")
    validation = json.loads(granchain(environment, tree, "validate", "run", "--json"))
    assert validation["passed"] is True
    # the uncertainty of the reference is some 2e-6 V
    assert validation["quantities"]["velocity"]["largest"] < 1e-5
    assert granchain(environment, tree, "status", "run").startswith("run: done")
