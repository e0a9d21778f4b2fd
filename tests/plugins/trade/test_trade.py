"""`granchain trade` on a small scene, from the command to its files."""

import contextlib
import csv
import io
import json

import numpy as np
import pytest

from lammps_inputs import Scene, strict_yaml
from workflow.cli import main
from workflow.engines.lammps import mpi
from workflow.engines.reference import engine
from workflow.plugins.trade import settings, study
from workflow.plugins.trade.study import plain_problem
from workflow.runs.run import run

SCENE = {
    **{"name": "small", "chains": 2, "beads": 10, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1.0}},
    **{"duration": 12.0, "timestep": 0.01, "output": {"every": 0.1}},
}

pytestmark = pytest.mark.usefixtures("lammps_here")


def written(directory, **changes):
    path = directory / "scene.yaml"
    path.write_text(strict_yaml.dump({**SCENE, **changes}))
    return str(path)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What the command says, its table, its report and its directory."""
    directory = tmp_path_factory.mktemp("trade")
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()) as out:
        patch.setattr(settings, "FINEST", {"verlet": 32, "suzuki4": 4, "blanes-moan": 8})
        patch.setattr(study, "REPEATS", 1)
        assert main(["trade", written(directory), "-o", str(directory / "out"), "--budget", "600"]) == 0
    rows = table(directory / "out" / "trade.csv")
    report = json.loads((directory / "out" / "trade.json").read_text())
    return out.getvalue(), rows, report, directory / "out"


def table(path):
    return list(csv.DictReader(io.StringIO(path.read_text())))


def of(rows, method):
    return [row for row in rows if row["method"] == method]


def velocity(row):
    return float(row["velocity_error"])


@pytest.mark.slow
def test_every_choice_is_measured_with_its_times_and_evaluations_of_forces(found):
    _, rows, report, directory = found
    always = {"LAMMPS verlet", "LAMMPS suzuki4", "reference blanes-moan"}
    assert {row["method"] for row in rows} == (always | {"LAMMPS ranks"} if mpi.cores() > 1 else always)
    for row in rows:
        assert velocity(row) > 0.0
        low, middle, high = (float(row[name]) for name in ("seconds_min", "seconds", "seconds_max"))
        assert 0.0 < low <= middle <= high
        assert float(row["first"]) > 0.0
        stages = 6 if row["method"] == "reference blanes-moan" else 1
        assert float(row["forces"]) == pytest.approx(12.0 / float(row["timestep"]) * stages)
    assert [row["setting"] for row in report["engines"]] == [row["setting"] for row in rows]
    files = {path.name for path in directory.iterdir()}
    assert files == {"trade.csv", "frames.csv", "trade.json", "trade.png", "run.json"}


@pytest.mark.slow
def test_verlet_has_order_two(found):
    # orders come in halves, for contacts open and close; a quarter tells 2 from what is next to it
    (order,) = [one for one in found[2]["orders"] if one["method"] == "LAMMPS verlet"]
    assert order["points"] >= 4
    assert order["order"] == pytest.approx(2.0, abs=0.25)


@pytest.mark.slow
def test_the_error_of_lammps_is_its_difference_from_a_much_finer_reference(found, tmp_path):
    scene = Scene.model_validate(SCENE)
    exact = engine.run(scene.problem(), steps_per_frame=400)
    own = run(scene, tmp_path / "run", check=False).trajectory
    error = float(np.abs(own.velocity - exact.velocity).max())
    row = next(row for row in of(found[1], "LAMMPS verlet") if float(row["timestep"]) == pytest.approx(0.01))
    assert velocity(row) == pytest.approx(error, abs=found[2]["reference"]["velocity"])


@pytest.mark.slow
def test_the_uncertainty_of_the_reference_is_below_all_errors_and_printed(found):
    sure = found[2]["reference"]["velocity"]
    assert sure <= 1e-10
    assert min(map(velocity, found[1])) > 10.0 * sure
    assert f"Uncertainty of the reference: {sure:.1e} V" in found[0]


def test_a_scene_that_asks_for_an_accuracy_or_a_scheme_is_measured_as_it_would_be_run():
    asked = {key: value for key, value in SCENE.items() if key != "timestep"}
    step = plain_problem(Scene.model_validate({**asked, "accuracy": 1e-3})).timestep
    assert step > plain_problem(Scene.model_validate({**asked, "accuracy": 1e-5})).timestep
    problem = plain_problem(Scene.model_validate({**asked, "scheme": "suzuki4"}))
    assert (problem.scheme, problem.timestep) == ("verlet", plain_problem(Scene.model_validate(asked)).timestep)
