"""The size of a run is printed before it, and one that is too large is refused before anything is written."""

import pytest
from bad_scenes import scene_text

from lammps_inputs import file_names, library
from lammps_inputs.output import Limits
from workflow.cli import main
from workflow.runs.engines import engine_called
from workflow.runs.run import run
from workflow.runs.size import size_of

STEEL = "{radius: 4.76e-3, density: 8000, youngs_modulus: 193e9, poisson_ratio: 0.3}"

WRONG = {"material": STEEL, "duration": "192", "output": "{every: 1.0e-6}", "timestep": "1.0e-7"}
"""A duration in units of T, in a scene that is in SI units."""


@pytest.fixture(autouse=True)
def nobodys_site(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("GRANCHAIN_SITE", raising=False)


@pytest.fixture
def written(tmp_path):
    def write(**lines):
        path = tmp_path / "scene.yaml"
        path.write_text(scene_text(**lines))
        return str(path)

    return write


@pytest.mark.usefixtures("lammps_here")
def test_steps_frames_and_bytes_are_those_of_the_run(tmp_path):
    plain = {"name": "a", "beads": 40, "kick": {"velocity": 1.0}, "duration": 20.0}
    scene = library.from_plain({**plain, "output": {"beads": [3, 7], "every": 0.1}}, "a")
    found, size = run(scene, tmp_path / "a", check=False).directory, size_of(scene.problem(), engine_called("lammps"))
    assert size.steps == found.job.steps
    assert size.frames == len(found.trajectory.time)
    dumped = (found.path / file_names.DUMP).stat().st_size
    assert size.bytes == pytest.approx(dumped, rel=0.01)


@pytest.mark.parametrize(("gigabytes", "code"), [("1e-4", 0), ("2e-5", 2)])
@pytest.mark.usefixtures("lammps_here")
def test_the_scene_sets_the_limit(gigabytes, code, written, tmp_path, monkeypatch):
    monkeypatch.setattr("workflow.runs.size.MOST", Limits(gigabytes=1e-9, hours=1.0))
    scene = written(limits=f"{{gigabytes: {gigabytes}}}")
    assert main(["run", scene, "-o", str(tmp_path / "out"), "--no-check"]) == code


def test_show_and_deck_warn_and_go_on(written, tmp_path, capsys):
    scene = written(**WRONG)
    assert main(["show", scene]) == 0
    assert "# warning: `granchain run` refuses 1,920,000,000 steps" in capsys.readouterr().out
    assert main(["deck", scene, "-o", str(tmp_path / "out")]) == 0
    assert "warning: 1,920,000,000 steps" in capsys.readouterr().out


def test_frames_farther_apart_than_the_run_is_long_are_warned_of(written, capsys):
    main(["show", written(duration="0.5", output="{every: 1}", timestep="0.01")])
    out = capsys.readouterr().out
    assert "# warning: output.every: 1 is longer than the duration of 0.5; the run lasts 1 and records" in out


def test_springs_between_chains_of_a_single_chain_are_warned_of(written, capsys):
    main(["show", written(coupling="{stiffness: 0.1}", timestep="0.01")])
    assert "# warning: coupling: a single chain has no springs between chains" in capsys.readouterr().out


def test_a_duration_of_many_units_of_time_is_warned_of_with_the_one_probably_meant(written, capsys):
    main(["show", written(material=STEEL, duration="20", output="{every: 1.0e-5}", timestep="1.0e-6")])
    assert "# warning: duration in s? 20 s is 1.63e+06 T" in capsys.readouterr().out
