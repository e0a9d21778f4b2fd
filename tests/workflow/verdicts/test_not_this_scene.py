"""Runs whose frames are not what their scene says, or say too little, are not analysed as if they were."""

import pytest
import stock_lammps
from plug_ins import needs
from refusals import refusal
from stock_lammps import scene

from lammps_inputs import Output, Scene, file_names
from lammps_inputs.decks import scene_files
from workflow.cli import main
from workflow.engines.reference import engine
from workflow.runs.frames import write_frames
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analysis_files import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

SMALL = scene(chains=2, beads=20, kappa=0.1, duration=20.0)


@pytest.fixture(scope="module")
def other_kick(tmp_path_factory):
    """The deck of `SMALL`, run with another kick."""
    path = tmp_path_factory.mktemp("other") / "run"
    stock_lammps.run(SMALL, path, "-var", "kick1", "0.9")
    return path


@pytest.mark.parametrize("command", ["analyze", "validate", pytest.param("view", marks=needs("pages"))])
def test_frames_of_another_kick_are_an_error_that_names_it(other_kick, capsys, command):
    line = refusal([command, other_kick], capsys, code=1)
    assert "its frames are not those of scene.yaml: kick1: 0.9, in the scene 1; for other values" in line
    assert not (other_kick / "analysis.json").exists()


@pytest.mark.parametrize(
    ("name", "value", "of_scene", "without_log"),
    [("timestep", "0.02", "0.01", "-var timestep"), ("every", "5", "10", "-var every"), ("kappa", "0.5", "0.1", "")],
)
def test_frames_of_other_times_or_springs_are_an_error_that_names_them_or_doubted_first_without_a_log(
    tmp_path, capsys, name, value, of_scene, without_log
):
    path = stock_lammps.run(SMALL, tmp_path / "r", "-var", name, value).directory
    assert f"{name}: {value}, in the scene {of_scene}" in refusal(["analyze", path], capsys, code=1)
    (path / file_names.LOG).unlink()
    if without_log:
        assert without_log in refusal(["analyze", path], capsys, code=1)
    else:
        main(["analyze", str(path), "--no-figures"])
        assert "these are not frames of this scene" in capsys.readouterr().out.splitlines()[1]


@pytest.mark.slow
def test_a_run_cut_short_by_its_steps_is_of_its_scene(tmp_path):
    path = stock_lammps.run(SMALL, tmp_path / "r", "-var", "steps", "500").directory
    found = analyse(RunDirectory(path), figures=False)
    assert (found.complete, found.conservation.frames) == (False, 51)


def test_frames_too_far_apart_to_find_a_wave_are_refused(tmp_path, capsys):
    coarse, directory = SMALL.model_copy(update={"output": Output(every=4.0)}), tmp_path / "r"
    directory.mkdir()
    scene_files.write(coarse.resolved(), directory)  # LAMMPS would leave such frames
    write_frames(directory / file_names.DUMP, coarse.problem(), engine.blocks(coarse.problem()))
    assert "output.every: frames are 4 apart, too far to find waves" in refusal(["analyze", directory], capsys)


@pytest.mark.slow
def test_a_run_that_ends_at_a_bead_shows_the_whole_shape_of_its_wave(tmp_path):
    ended = Scene.model_validate({"name": "ended", "beads": 60, "kick": {"velocity": 1.0}, "until_bead": 50})
    found = analyse(run(ended, tmp_path / "r", check=False).directory, figures=False)
    leader = found.survey.characters[0]
    assert leader is not None
    assert leader.solitary


@pytest.mark.slow
def test_a_reference_that_is_not_sure_enough_passes_nothing(tmp_path):
    directory = run(SMALL, tmp_path / "r", check=False).directory
    assert validate(directory).passed
    impossible = validate(RunDirectory(directory.path), {"velocity": 1e-3, "arrival": 1e-17})
    assert not impossible.passed
    assert any("the uncertainty of the reference" in remark for remark in impossible.remarks)
