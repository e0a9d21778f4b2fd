"""What keeps a large scene's output small: snapshots beside frames of a few beads."""

import json
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest
from processes import HANGS
from stock_lammps import scene

from lammps_inputs import Output, file_names
from workflow import cli
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")

FEW = Output(every=0.2, beads=(5, 20), snapshots=2.0)


def long_scene(**changes):
    return scene(**{"chains": 2, "beads": 40, "kappa": 0.1, "duration": 60.0, "timestep": 0.02, **changes})


def sparse(case):
    """The case with frames of two beads, and snapshots of all."""
    return case.model_copy(update={"output": FEW})


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """The run directories with all frames and with few."""
    root = tmp_path_factory.mktemp("large")
    case = long_scene(every=0.2)
    return run(case, root / "all", check=False).directory, run(sparse(case), root / "few", check=False).directory


def test_a_flipped_bit_in_a_snapshot_changes_the_fingerprint_and_is_said(both, tmp_path, capsys):
    copy = tmp_path / "copy"
    shutil.copytree(both[1].path, copy)
    assert not analyse(RunDirectory(copy), figures=False).altered
    content = bytearray((copy / file_names.SNAPSHOTS).read_bytes())
    content[-3] ^= 1
    (copy / file_names.SNAPSHOTS).write_bytes(content)
    assert cli.main(["analyze", str(copy), "--no-figures"]) == 0
    assert "the checksum of the frames is not that in run.json" in capsys.readouterr().out
    assert cli.main(["validate", str(copy), "--against", str(both[1].path)]) == 1
    assert "not bitwise the same" in capsys.readouterr().out


def test_snapshots_are_the_frames_of_the_whole_run_at_their_times(both):
    whole, few = both
    expected, found = whole.trajectory, list(few.snapshots())
    velocity = np.concatenate([block.velocity for block in found])
    assert np.array_equal(velocity, expected.velocity[::10])


@pytest.mark.slow
def test_energy_and_momentum_are_told_from_the_snapshots(both, draw_only):
    draw_only("spacetime")
    analyse(both[1])
    told = json.loads((both[1].path / "analysis.json").read_text())
    assert told["energy_drift"] < 1e-4
    assert told["momentum_drift"] < 1e-12
    assert (both[1].path / "spacetime.png").is_file()


def test_a_run_whose_snapshots_are_gone_is_analysed_without_them(tmp_path):
    directory = run(sparse(long_scene(duration=4.0)), tmp_path / "run", check=False).directory
    (directory.path / file_names.SNAPSHOTS).unlink()
    assert "spacetime.png" not in {path.name for path in analyse(directory).figures}


KILLED = """
import os, signal
from pathlib import Path
from lammps_inputs import load
from workflow.engines.lammps import hosted
from workflow.runs.run import run

def killed(directory, *, problem, **_):
    def progress(*_):
        if Path("chains.restart").exists():
            os.kill(os.getpid(), signal.SIGKILL)
    return hosted.run(directory, problem=problem, progress=progress, restart_every=0.0)

run(load(Path("scene.yaml")), "cut", check=False, lammps=killed)
"""
"""Kills itself when it has gone on after the first restart."""


@pytest.mark.slow
def test_a_run_that_was_killed_goes_on_to_the_same_snapshots(both, tmp_path):
    _, whole = both
    shutil.copy(whole.path / file_names.SCENE, tmp_path)
    with subprocess.Popen([sys.executable, "-c", KILLED], cwd=tmp_path, stdin=subprocess.PIPE) as process:
        assert process.wait(HANGS) == -signal.SIGKILL
    again = resume(tmp_path / "cut", check=False)
    assert again.directory.job.resumed[0].from_step > 0
    velocity = [np.concatenate([block.velocity for block in part.snapshots()]) for part in (whole, again.directory)]
    assert np.array_equal(*velocity)
