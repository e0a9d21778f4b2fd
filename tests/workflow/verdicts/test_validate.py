"""Good runs pass; wrong ones are caught and named; what a validation says on the screen, in a file and as exit code."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import wrong_runs
from stock_lammps import scene

from analysis.files.recording import Writer
from lammps_inputs import Kick, file_names, find
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.validate import REPORT, validate

pytestmark = pytest.mark.usefixtures("lammps_here")

SCENE = scene(chains=2, beads=24, kappa=0.1, duration=40.0)


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    """The deck of `SCENE`, run by plain ``lmp``."""
    return wrong_runs.deck_run(SCENE, tmp_path_factory.mktemp("validate") / "good")


@pytest.fixture(scope="module")
def validated(good, tmp_path_factory):
    """What is found of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("workflow.verdicts.validate.write_figure", lambda *_: ())
        copy = shutil.copytree(good.path, tmp_path_factory.mktemp("validated") / "run")
        return validate(RunDirectory(copy))


def frames_written(directory, frames):
    """The same run, of which only the first frames are there."""
    trajectory = directory.trajectory
    with Writer(directory.path / file_names.DUMP, directory.problem) as writer:
        for frame in range(frames):
            step = frame * directory.problem.steps_per_frame
            writer.append(step, trajectory.displacement[frame], trajectory.velocity[frame])
    return directory


# --- good runs --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_of_the_reference_passes_without_any_difference(tmp_path):
    found = validate(run(SCENE, tmp_path / "run", engine="reference").directory)
    assert found.passed
    # positions below 256 were rounded on their way into the dump
    assert max(found.deviations[name].largest for name in ("velocity", "displacement", "arrival")) < 1e-12
    assert found.uncertainty.velocity > 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.0, 0.1])
def test_a_run_of_some_beads_passes_without_energy_and_momentum(gap, tmp_path):
    found = validate(
        wrong_runs.deck_run(
            scene(chains=2, beads=40, kappa=0.1, gap=gap, duration=40.0, recorded=(2, 9, 25)), tmp_path / "run"
        )
    )
    assert found.passed
    assert list(found.deviations) == ["velocity", "displacement", "amplitude", "arrival"]


@pytest.mark.slow
def test_motion_in_round_numbers_is_not_taken_for_rounding(tmp_path):
    free = scene(beads=40, gap=50.0, duration=40.0, kick=(Kick(bead=2, velocity=1.0),))
    assert validate(wrong_runs.deck_run(free, tmp_path / "run")).passed


# --- wrong runs, each named -------------------------------------------------------------------------------------------

SLOW = pytest.mark.slow
DECKS = (
    pytest.param(wrong_runs.CUBIC, "the exponent of the coupling is larger by", id="cubic coupling"),
    pytest.param(wrong_runs.without_spring(8), "between chains 1 and 2 in row 8 is missing", id="a spring"),
)
DUMPS = (
    pytest.param(wrong_runs.at_half_steps, "before the positions (half-step velocities?)", id="half steps"),
    pytest.param(
        lambda run: (run.displacement, np.where(run.time[:, None, None] > 30.05, np.nan, run.velocity)),
        "from t = 30.1 on",
        id="not a number",
    ),
)


def is_named(directory, says, capsys):
    """A validation fails, and its output and report name the cause."""
    assert main(["validate", str(directory.path)]) == 1
    said = capsys.readouterr().out
    assert "NOT passed" in said
    assert says in said
    report = json.loads((directory.path / REPORT).read_text())
    assert report["passed"] is False
    assert any(says in cause for cause in report["causes"])


@pytest.mark.slow
@pytest.mark.parametrize(("edit", "says"), DECKS)
def test_a_wrong_deck_is_caught_and_named(edit, says, tmp_path, capsys):
    is_named(wrong_runs.deck_run(SCENE, tmp_path / "run", edit), says, capsys)


@pytest.mark.parametrize(("change", "says"), DUMPS)
def test_a_wrong_dump_is_caught_and_named(change, says, good, tmp_path, capsys):
    is_named(wrong_runs.rewritten(good, tmp_path / "run", change), says, capsys)


@pytest.mark.slow
def test_the_first_wrong_bead_and_time_are_named(good, tmp_path, capsys):
    def struck(trajectory):
        velocity = trajectory.velocity.copy()
        velocity[123:, 1, 6] += 0.01
        return trajectory.displacement, velocity

    main(["validate", str(wrong_runs.rewritten(good, tmp_path / "run", struck).path)])
    assert (
        "a tolerance is first exceeded by the velocity of bead 7 of chain 2, at t = 12.3"
        in capsys.readouterr().out.splitlines()
    )


def test_every_cause_is_named_in_the_units_of_the_scene():
    steel = find("two-chains-steel").model_copy(update={"beads": 20, "duration": 3e-4})
    coupled, alone = (engine.run(case.problem()) for case in (steel, steel.model_copy(update={"coupling": None})))
    (cause,) = wrong_runs.causes(replace(coupled, problem=alone.problem), alone)
    assert cause == "the coupling of 2.41e+06 N/m is not in the scene"


# --- runs that are not whole, or of something else --------------------------------------------------------------------


@pytest.mark.slow
def test_an_interrupted_run_is_said_incomplete_and_does_not_pass(good, tmp_path, capsys):
    part = frames_written(RunDirectory(shutil.copytree(good.path, tmp_path / "part")), 200)
    with (part.path / file_names.DUMP).open("ab") as file:
        file.write((good.path / file_names.DUMP).read_bytes()[:1000])  # killed within a frame
    assert main(["validate", str(part.path)]) == 1
    assert "the run is incomplete: 200 of 401 frames" in capsys.readouterr().out.splitlines()
    report = json.loads((part.path / REPORT).read_text())
    assert (report["complete"], report["frames"]) == (False, [200, 401])
    assert not any(quantity["exceeded"] for quantity in report["quantities"].values())


# --- tolerances and the report ----------------------------------------------------------------------------------------


def test_the_velocity_error_is_that_of_an_independent_comparison(good, validated):
    found = validated
    own, fine = good.trajectory, engine.run(good.problem, steps_per_frame=64)
    error = np.abs(own.velocity - fine.velocity)
    assert found.deviations["velocity"].largest == pytest.approx(error.max(), abs=2.0 * found.uncertainty.velocity)
    assert found.deviations["velocity"].rms == pytest.approx(
        np.sqrt(np.mean(error**2)), abs=2.0 * found.uncertainty.velocity
    )
