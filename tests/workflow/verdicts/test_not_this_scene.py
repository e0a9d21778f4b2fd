"""Runs whose frames are not what their scene says, or say too little, are not analysed as if they were."""

from pathlib import Path

import pytest
import stock_lammps
from refusals import refusal
from stock_lammps import scene

from lammps_inputs import Output, Scene
from workflow.cli import main
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import analyse
from workflow.verdicts.validate import validate

pytestmark = pytest.mark.usefixtures("lammps_here")

SMALL = scene(chains=2, beads=20, kappa=0.1, duration=20.0)


@pytest.mark.parametrize("changed", [("timestep", "0.02"), ("every", "5")])
def test_other_times_than_the_scenes_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], changed: tuple[str, str]
) -> None:
    stock_lammps.run(SMALL, tmp_path / "r", "-var", *changed)
    assert "Change the scene instead" in refusal(["analyze", tmp_path / "r"], capsys)


def test_another_kappa_is_said_loudly(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stock_lammps.run(SMALL, tmp_path / "r", "-var", "kappa", "0.5")
    main(["analyze", str(tmp_path / "r"), "--no-figures"])
    assert "these are not frames of this scene" in capsys.readouterr().out


def test_frames_too_far_apart_to_find_a_wave_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(SMALL.model_copy(update={"output": Output(every=4.0)}), tmp_path / "r", check=False)
    assert "output.every at most 2" in refusal(["analyze", tmp_path / "r"], capsys)


def test_a_run_that_ends_at_a_bead_shows_the_whole_shape_of_its_wave(tmp_path: Path) -> None:
    ended = Scene.model_validate({"name": "ended", "beads": 60, "kick": {"velocity": 1.0}, "until_bead": 50})
    found = analyse(run(ended, tmp_path / "r", check=False).directory, figures=False)
    leader = found.survey.characters[0]
    assert leader is not None
    assert leader.solitary


def test_a_reference_that_is_not_sure_enough_passes_nothing(tmp_path: Path) -> None:
    directory = run(SMALL, tmp_path / "r", check=False).directory
    assert validate(directory).passed
    impossible = validate(RunDirectory(directory.path), {"velocity": 1e-3, "arrival": 1e-17})
    assert not impossible.passed
    assert any("the uncertainty of the reference" in remark for remark in impossible.remarks)
