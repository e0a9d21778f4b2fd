"""A distribution beside granchain adds laws, an ingredient, a material, a scene, a quantity, a study, a function."""

import csv
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from extending import in_turn
from processes import output_of
from stock_lammps import WHEEL

from lammps_inputs import strict_yaml

pytest_plugins = ("slurm",)
pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
TEMPLATE = ROOT / "tests" / "support" / "template_package"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Directory in which the template package is installed from its wheel."""
    place = tmp_path_factory.mktemp("template")
    output_of(sys.executable, "-m", "pip", "install", "-q", "--target", place / "backend", "hatchling>=1.27")
    code = f"import hatchling.build as made; print(made.build_wheel({str(place)!r}))"
    environment = {"PYTHONPATH": str(place / "backend"), "PATH": "/usr/bin:/bin"}
    wheel = place / output_of(sys.executable, "-c", code, cwd=TEMPLATE, env=environment).split()[-1]
    output_of(
        sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-compile", "--target", place / "site", wheel
    )
    return place / "site"


def environment(site):
    """Environment in which the package is installed beside the tree."""
    return {"PYTHONPATH": f"{site}:{ROOT}", "PATH": "/usr/bin:/bin", "HOME": str(site)}


def granchain(site, folder, *commands):
    """What each of some commands prints."""
    return in_turn(environment(site), folder, *commands)


@pytest.fixture(scope="module")
def folder(site, tmp_path_factory):
    """Folder in which the package's scene was run and analysed."""
    folder = tmp_path_factory.mktemp("used")
    granchain(site, folder, ["run", "tungsten-on-a-bed", "-o", "run"])
    return folder


def test_its_scene_material_and_law_run_in_lammps_within_the_error_that_is_stated(folder):
    record = json.loads((folder / "run" / "run.json").read_text())
    assert record["outcome"] == "done"
    assert record["check"]["velocity"] < record["settings"]["accuracy"]
    assert "strain^5" in (folder / "run" / "in.chains").read_text().replace("(", "").replace(")", "")


def test_its_quantity_is_printed_written_and_collected(site, folder):
    (folder / "sweep.yaml").write_text(
        "scene: tungsten-on-a-bed\nvary: {kick.velocity: [0.1, 0.2]}\n"  # the first is the run above
    )
    printed, explained, key, *_ = granchain(
        site,
        folder,
        ["analyze", "run", "--no-figures"],
        ["help", "largest_backwards"],
        ["help", "bed.quintic"],
        ["sweep", "sweep.yaml", "-o", "cases", "--jobs", "1"],
        ["collect", "cases"],
    )
    assert "largest velocity backwards" in printed
    stated = json.loads((folder / "run" / "analysis.json").read_text())["rebound"]["largest"]
    assert stated > 0.0
    assert "largest velocity of any bead towards lower numbers" in explained
    assert "Force over the fifth power of the displacement." in key
    with (folder / "cases" / "table.csv").open(newline="") as file:
        column = next(name for name in next(csv.reader(file)) if name.startswith("largest_backwards"))
        file.seek(0)
        values = [float(row[column]) for row in csv.DictReader(file)]
    assert values[0] == pytest.approx(stated, rel=1e-3)
    assert values[1] > values[0]


def test_its_law_of_contacts_is_chosen_by_a_key(site, tmp_path):
    plain = {"name": "stiff", "beads": 9, "kick": {"velocity": 1}, "duration": 5, "contact": {"stiffening": 0.5}}
    (tmp_path / "stiff.yaml").write_text(strict_yaml.dump(plain))
    granchain(site, tmp_path, ["run", "stiff.yaml", "-o", "stiff"])
    record = json.loads((tmp_path / "stiff" / "run.json").read_text())
    assert 0.0 < record["check"]["velocity"] < record["settings"]["accuracy"]


def test_its_study_is_a_command_and_its_function_one_of_the_module(site, tmp_path):
    _, state = granchain(site, tmp_path, ["hardness", "-o", "hard"], ["status", "hard"])
    with (tmp_path / "hard" / "hardness.csv").open(newline="") as file:
        numbers = [float(row["participation"]) for row in csv.DictReader(file)]
    assert len(numbers) == 3
    assert np.all(np.isfinite(numbers))
    assert "done" in state
    code = "import granchain; print('hardness' in dir(granchain), *granchain.hardness('hard', jobs=1))"
    assert output_of(sys.executable, "-P", "-c", code, cwd=tmp_path, env=environment(site)) == "True 0.5 1.0 2.0\n"


def test_its_law_runs_in_a_job_of_slurm(slurm, site, folder):
    (folder / "site.yaml").write_text(strict_yaml.dump({"launcher": "srun --mpi=pmi2", "lmp": str(WHEEL)}))
    granchain(site, folder, ["deck", "tungsten-on-a-bed", "-o", "job", "--slurm", "--site", "site.yaml"])
    slurm.submit(folder / "job")
    slurm.wait()
    analyses = (["analyze", name, "--no-figures"] for name in ("run", "job"))
    state, *_ = granchain(site, folder, ["status", "job"], *analyses)
    assert "done" in state
    here, there = (
        json.loads((folder / name / "analysis.json").read_text())["rebound"]["largest"] for name in ("run", "job")
    )
    assert there == here
