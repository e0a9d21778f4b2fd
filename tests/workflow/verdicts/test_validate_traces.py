"""A run against traces: its own forces read back, those of another chain found wrong, and what cannot be compared."""

import json

import numpy as np
import pytest
from refusals import refusal

from lammps_inputs import library
from workflow.cli import main
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

SCENE = {
    "name": "traced",
    "chains": 2,
    "beads": 12,
    "coupling": {"stiffness": 0.1},
    "walls": {"right": "rigid"},
    "kick": {"velocity": 1},
    "duration": 25,
    "output": {"forces": {"wall": True, "contacts": [5], "sensors": [8]}},
}


@pytest.fixture(scope="module")
def directory(tmp_path_factory, request):
    request.getfixturevalue("lammps_here")
    path = tmp_path_factory.mktemp("traced") / "r"
    run(library.from_plain(SCENE, "scene"), path, check=False)
    assert main(["analyze", str(path), "--no-figures"]) == 0
    return path


def written(directory, names, factor=1.0, shift=0.0):
    """A table of the run's own forces, changed, under other names."""
    own = np.genfromtxt(directory / "forces.csv", delimiter=",", names=True)
    columns = [own["time"] + shift, *(factor * own[name] for name in names.values())]
    path = directory.parent / "given.csv"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=",".join(("time", *names)), comments="")
    return path


def test_forces_csv_reads_back_as_the_run_that_it_is_of(directory):
    assert main(["validate", str(directory), "--against", str(directory / "forces.csv")]) == 0
    found = json.loads((directory / "validation.json").read_text())
    assert len(found["quantities"]) == 6
    assert all(entry["largest"] < 1e-12 for entry in found["quantities"].values())


def test_a_trace_that_is_off_is_named_with_place_and_time(directory, capsys):
    path = written(directory, {"force_sensor_8_chain_2": "sensor_8_chain_2"}, factor=1.05)
    assert main(["validate", str(directory), "--against", str(path)]) == 1
    found = json.loads((directory / "validation.json").read_text())["quantities"]["force_sensor_8_chain_2"]
    own = np.genfromtxt(directory / "forces.csv", delimiter=",", names=True)["sensor_8_chain_2"]
    assert found["largest"] == pytest.approx(0.05 * own.max(), rel=1e-6)
    assert found["where"]["chain"] == 2
    assert "first deviation: force_sensor_8_chain_2 of bead 8" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "shift", "says"),
    [
        ("force_wall_left", 0.0, "the scene has no left wall"),
        ("force_contact_12", 0.0, "beads 1 to 11 of the scene have such"),
        ("force_contact_5_chain_3", 0.0, "the scene has chains 1 to 2"),
        ("force_contact_5 (N)", 0.0, "names units"),
        ("force_contact_5", 3.0, "reach beyond the run's"),
    ],
)
def test_what_cannot_be_compared_is_one_line(name, shift, says, directory, capsys):
    path = written(directory, {name: "contact_5_chain_1"}, shift=shift)
    assert says in refusal(["validate", directory, "--against", path], capsys)
