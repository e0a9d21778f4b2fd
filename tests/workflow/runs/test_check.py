"""Every LAMMPS run ends with its measured error, which is that of a full comparison, as run.json says."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem
from stock_lammps import scene

from analysis.compare.difference import errors_of
from analysis.trajectory import joined
from lammps_inputs import library, strict_yaml
from workflow.cli import main
from workflow.commands.run import _exit_code
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import accurate_reference
from workflow.prepare.step_choice import ChosenStep
from workflow.runs import check as checking
from workflow.runs.check import check, stride
from workflow.runs.run import prepare_run, run, run_prepared
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

SCENE = scene(chains=2, beads=40, kappa=0.1, duration=40.0)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A run of `SCENE` through LAMMPS, with its check."""
    return run(SCENE, tmp_path_factory.mktemp("check") / "run")


@pytest.fixture(scope="module")
def full(finished):
    """Deviations of all its frames from a reference with an uncertainty of 1e-9."""
    problem = finished.directory.problem
    return errors_of(finished.directory.blocks(), accurate_reference(problem, 1e-9).blocks())


@pytest.mark.slow
def test_of_a_little_run_its_velocity_error_is_the_full_one(finished, full):
    sure = finished.check.reference.velocity + 1e-9
    assert finished.check.velocity == pytest.approx(full["velocity"].largest, abs=sure)
    assert finished.check.where == full["velocity"].where


@pytest.fixture
def sampled(finished, monkeypatch):
    """Its check, as if it were no little run."""
    monkeypatch.setattr(checking, "LITTLE", 0)
    return replace(finished, check=check(finished.directory))


def test_its_velocity_error_is_the_largest_of_the_frames_that_it_compares(sampled):
    directory = sampled.directory
    step = stride(directory.problem)
    fine = accurate_reference(directory.problem, 1e-9)
    exact = engine.run(directory.problem, steps_per_frame=fine.steps_per_frame).velocity[::step]
    error = np.max(np.abs(directory.trajectory.velocity[::step] - exact))
    assert sampled.check.velocity == pytest.approx(error, abs=sampled.check.reference.velocity + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["arrival", "amplitude"])
def test_its_wave_errors_are_the_full_ones(quantity, sampled, full):
    # peaks are found to 1e-5 between frames 0.4 apart, in both runs with nearly the same error
    assert getattr(sampled.check, quantity) == pytest.approx(full[quantity].largest, abs=1e-5)


@pytest.mark.parametrize(
    ("changes", "frames"),
    [
        *(
            ({"timestep": 0.1 * every}, frames)
            for every, frames in ((0.05, 8), (0.1, 4), (0.15, 2), (0.4, 1), (3.0, 1))
        ),
        ({"kappa": 50.0, "timestep": 0.001, "frames": 6000}, 15),  # four in the period of the springs, 0.628
        ({"timestep": 0.001, "frames": 100}, 1),  # so few are all compared
    ],
)
def test_frames_are_taken_0_4_apart_or_four_in_a_swing_or_as_near_to_it_as_there_are_any(changes, frames):
    assert stride(problem(**{"frames": 600, **changes})) == frames


@pytest.fixture(scope="module")
def light_resonators(tmp_path_factory):
    """Two beads with resonators of 1/100 of their mass, whose dashpots leave errors of first order in the step."""
    keys = {"beads": 2, "resonators": {"mass": 0.01, "stiffness": 0.1, "damping": 0.005}, "kick": {"velocity": 1}}
    made = library.from_plain({"name": "light", "duration": 4.0, **keys}, "light")
    rough = made.model_copy(update={"timestep": 0.01})
    return made, run(rough, tmp_path_factory.mktemp("check") / "light").directory


@pytest.mark.slow
def test_its_velocity_error_and_a_validation_are_also_of_resonators(light_resonators):
    _, directory = light_resonators
    stated, exact = check(directory), joined(accurate_reference(directory.problem, 1e-9).blocks())
    (of_beads, of_resonators) = (
        np.max(np.abs(own - right))
        for own, right in zip(
            (directory.trajectory.velocity, directory.trajectory.further_lines[:, 1]),
            (exact.velocity, exact.further_lines[:, 1]),
            strict=True,
        )
    )
    assert of_resonators > 10.0 * of_beads
    assert stated.velocity == pytest.approx(of_resonators, abs=stated.reference.velocity + 1e-9)
    assert stated.where.words.startswith("resonator 1 at bead ")
    found = validate(directory)
    uncertainty = stated.reference.velocity + found.uncertainty.velocity
    assert found.deviations["velocity"].largest == pytest.approx(stated.velocity, abs=uncertainty)
    assert not found.passed


@pytest.mark.slow
def test_a_time_step_for_an_accuracy_keeps_it_in_resonators(light_resonators, tmp_path):
    ready = prepare_run(light_resonators[0], tmp_path / "run")
    settings, directory = ready.step, run_prepared(ready).directory
    assert settings.expected_error <= settings.accuracy
    assert directory.job.check.velocity == pytest.approx(settings.measured_error, rel=0.1)


@pytest.mark.slow
def test_short_runs_and_those_of_some_beads_are_checked_and_recorded_without_nan(tmp_path):
    for duration in (0.05, 0.35):  # less than the spacing of frames that are compared
        assert 0.0 <= run(scene(beads=4, duration=duration), tmp_path / f"{duration}").check.velocity < 1e-4
    found = run(scene(chains=2, beads=20, kappa=0.1, duration=20.0, recorded=(3, 11)), tmp_path / "run")
    assert 0.0 < found.check.velocity < 1e-3
    record = json.loads((tmp_path / "run" / "run.json").read_text(), parse_constant=pytest.fail)
    assert record["check"]["reference"]["energy"] is None


@pytest.mark.slow
def test_the_time_step_that_is_named_divides_the_output_and_keeps_what_is_said_of_it(tmp_path, capsys):
    coarse = {"name": "coarse", "beads": 12, "kick": {"velocity": 1}, "duration": 16, "output": {"every": 0.7}}
    path = tmp_path / "scene.yaml"
    path.write_text(strict_yaml.dump({**coarse, "timestep": 0.05}))
    assert main(["run", str(path), "-o", str(tmp_path / "coarse")]) == 0
    named = re.search(r"velocities is more than 0.0005 V; `timestep: (.*)` leaves (.*) V", capsys.readouterr().out)
    path.write_text(strict_yaml.dump({**coarse, "timestep": float(named[1])}))
    assert main(["run", str(path), "-o", str(tmp_path / "fine")]) == 0
    assert "is more than" not in capsys.readouterr().out
    left = RunDirectory(tmp_path / "fine").job.check.velocity
    assert left <= 1.05 * float(named[2])  # which is printed with two digits
    assert left <= 5e-4


# --- what is said of it -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("velocity", "sure", "asked", "code", "says"),
    [
        (4e-4, 1e-5, None, 0, ""),
        (4e-4, 6e-4, None, 0, "too large to compare the error with 0.0005 V; `granchain validate` takes a finer one"),
        (6e-4, 2e-4, None, 0, "inconclusive"),
        (9e-4, 2e-4, None, 0, "the error of velocities is more than 0.0005 V"),
        (2e-4, 1e-5, False, 0, "the error of velocities is more than 0.0001 V"),  # the default accuracy
        (9e-5, 9e-5, True, 0, ""),
        (2e-4, 1e-5, True, 1, "the error of velocities is more than 0.0001 V, although the pilot run had less"),
        (9e-5, 2e-4, True, 1, "too large to compare the error with 0.0001 V; errors grow"),
    ],
)
def test_an_error_is_said_to_be_too_large_as_far_as_it_is_certain_and_is_a_failure_where_less_was_asked(
    velocity, sure, asked, code, says, finished, capsys
):
    told = replace(finished.check, velocity=velocity, reference=replace(finished.check.reference, velocity=sure))
    chosen = ChosenStep(1e-4, 0.01, 10, 0.1, 5e-5, 5e-5, 1.0, limited=False, seconds=0.1, asked=asked is True)
    assert _exit_code(told, finished.directory.scene, None if asked is None else chosen) == code
    printed = capsys.readouterr().out
    assert says in printed
    assert bool(says) == bool(printed)
