"""The command line: what is wrong is one line on standard error, exit code 2, and nothing written."""

import contextlib
import os
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
from bad_scenes import scene_text
from processes import HANGS
from stock_lammps import scene
from sweeps import GRANCHAIN

from lammps_inputs import installed_scenes, library, strict_yaml
from workflow.cli import main
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A finished run of two short chains."""
    path = tmp_path_factory.mktemp("finished") / "run"
    run(scene(chains=2, beads=12, kappa=0.1, duration=10.0), path, check=False)
    return path


@pytest.fixture
def a_run(finished, tmp_path):
    """A copy of it that may be spoiled."""
    return shutil.copytree(finished, tmp_path / "run")


@pytest.mark.parametrize("record", [None, b"\xff"])
def test_a_run_is_analysed_whatever_run_json_holds(record, a_run, capsys):
    (a_run / "run.json").unlink()
    if record is not None:
        (a_run / "run.json").write_bytes(record)
    assert main(["analyze", str(a_run), "--no-figures"]) == 0
    assert capsys.readouterr().err == ""
    assert (a_run / "waves.csv").exists()


@contextlib.contextmanager
def no_output():
    """Standard output that takes nothing."""
    errors = contextlib.suppress(OSError)  # at its end
    with pytest.MonkeyPatch.context() as patch, errors, Path("/dev/full").open("w") as full:
        patch.setattr(sys, "stdout", full)
        yield


def test_a_command_whose_output_is_lost_writes_its_files_and_says_so_in_one_line(a_run, capsys):
    said = "granchain: standard output: cannot be written (No space left on device)"
    with no_output():
        assert main(["analyze", str(a_run), "--no-figures"]) == 0
    assert capsys.readouterr().err == f"{said}; the results are in the files\n"
    assert (a_run / "waves.csv").exists()
    with no_output():
        assert main(["show", "two-chains"]) == 1  # which only prints
    assert capsys.readouterr().err == f"{said}\n"


TEXTS = {
    "installed": strict_yaml.dump(library.load_plain(installed_scenes.installed()["column-of-rings"])),
    "until a bead": scene_text(duration=None, until_bead="7"),
    "several kicks": scene_text(kick="[{bead: 1, velocity: 1.0}, {bead: 9, velocity: -0.3}]", output="{beads: [9, 2]}"),
    "gap": scene_text(gap="0.1", chains="2", coupling="{stiffness: 0.123456789012345678}"),
    "text like a number": scene_text(name="'1e5'", description="'yes: no # null'"),
    "window": scene_text(beads="300", window="auto"),
    "accuracy": scene_text(accuracy="1e-4"),
    "time step": scene_text(timestep="0.01"),
}


def shown(text, directory, capsys):
    path = directory / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    assert main(["show", str(path)]) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("kind", TEXTS)
def test_without_trials_show_prints_a_scene_that_leaves_open_what_the_scene_does(kind, tmp_path, capsys):
    printed = shown(TEXTS[kind], tmp_path, capsys)
    one, other = (library.from_plain(strict_yaml.parse(each, "here"), "here") for each in (TEXTS[kind], printed))
    assert other.resolved() == one.resolved()
    for key in ("duration", "until_bead", "window", "accuracy", "timestep"):
        assert getattr(other, key) == getattr(one, key)
    assert shown(printed, tmp_path, capsys) == printed
    assert ("find by trials" in printed) == (one.timestep is None or one.until_bead is not None)


@pytest.mark.slow
def test_a_reader_that_has_gone_away_leaves_no_traceback():
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run([GRANCHAIN, "scenes"], stdout=writing, stderr=subprocess.PIPE, text=True, timeout=HANGS)
    os.close(writing)
    assert done.stderr.count("\n") <= 1
    assert "Traceback" not in done.stderr
    assert "Broken" not in done.stderr


def test_the_version_is_told_with_those_of_all_that_numbers_depend_on(capsys):
    with pytest.raises(SystemExit) as done:
        main(["--version"])
    lines = capsys.readouterr().out.splitlines()
    assert not done.value.code
    assert lines[0] == f"granchain {version('granchain')}"
    assert f"lammps {version('lammps')}, numpy {version('numpy')}" in lines[1]
