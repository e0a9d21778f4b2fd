"""What keeps a large scene's output small: snapshots beside frames of a few beads, peaks found while LAMMPS runs."""

import json
import shutil
import signal
import subprocess
import sys
from dataclasses import fields

import numpy as np
import pytest
from processes import HANGS
from stock_lammps import scene

from analysis.tracking.leading_waves import from_csv
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import blocks
from lammps_inputs import Kick, Output, file_names
from workflow import cli
from workflow.engines.reference import engine
from workflow.runs.resume import resume
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.analyse import analyse

pytestmark = pytest.mark.usefixtures("lammps_here")

FEW = Output(every=0.2, beads=(5, 20), snapshots=2.0, peaks=True)


def long_scene(**changes):
    return scene(**{"chains": 2, "beads": 40, "kappa": 0.1, "duration": 60.0, "timestep": 0.02, **changes})


def read_peaks(directory):
    return from_csv((directory.path / file_names.PEAKS).read_text(), directory.problem.scale)


def sparse(case):
    """The case with frames of two beads, snapshots, and peaks of all."""
    return case.model_copy(update={"output": FEW})


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """The run directories with all frames and with few."""
    root = tmp_path_factory.mktemp("large")
    case = long_scene(every=0.2)
    return run(case, root / "all", check=False).directory, run(sparse(case), root / "few", check=False).directory


def test_peaks_found_on_the_way_are_those_found_in_the_frames_of_all_beads(both):
    whole, few = both
    waves = analyse(whole, figures=False).waves
    peaks = read_peaks(few)
    for name in {field.name for field in fields(peaks)} - {"time"}:
        # the dump holds places, whose displacements are rounded at 1e-13, so bit for bit the maxima are not the same
        np.testing.assert_allclose(getattr(peaks, name), getattr(waves, name), atol=1e-11, err_msg=name)


@pytest.mark.parametrize(
    "kicks",
    [
        (Kick(bead=40, velocity=-1.0),),
        (Kick(bead=40, velocity=-1.0), Kick(bead=1, velocity=0.4)),
        (Kick(bead=1, velocity=1.0), Kick(bead=40, velocity=-0.4)),
    ],
)
def test_peaks_found_on_the_way_are_those_of_the_hardest_kick_also_towards_bead_1(kicks, tmp_path):
    case = long_scene(chains=1, kappa=0.0, every=0.2).model_copy(update={"kick": kicks})
    whole = run(case, tmp_path / "all", check=False).directory
    few = run(sparse(case), tmp_path / "few", check=False).directory
    waves, peaks = analyse(whole, figures=False).waves, read_peaks(few)
    assert np.array_equal(peaks.bead, waves.bead)
    assert peaks.peak_velocity.max() > 0.6
    assert len(peaks) > 20
    np.testing.assert_allclose(peaks.peak_velocity, waves.peak_velocity, atol=1e-11)
    np.testing.assert_allclose(peaks.arrival, waves.arrival, atol=1e-9)


def test_peaks_are_the_same_to_the_last_byte_however_often_a_restart_is_written(both, tmp_path):
    often = run(sparse(long_scene(every=0.2)), tmp_path / "often", check=False, restart_every=0.001).directory
    assert (often.path / file_names.PEAKS).read_bytes() == (both[1].path / file_names.PEAKS).read_bytes()


def test_a_flipped_bit_in_a_snapshot_changes_the_fingerprint_and_is_said(both, tmp_path, capsys):
    copy = tmp_path / "copy"
    shutil.copytree(both[1].path, copy)
    assert not analyse(RunDirectory(copy), figures=False).altered
    content = bytearray((copy / file_names.SNAPSHOTS).read_bytes())
    content[-3] ^= 1
    (copy / file_names.SNAPSHOTS).write_bytes(content)
    assert cli.main(["analyze", str(copy), "--no-figures"]) == 0
    assert "frame checksum mismatch" in capsys.readouterr().out
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


@pytest.mark.slow
def test_two_ranks_find_the_same_peaks(both, tmp_path):
    two = run(sparse(long_scene(every=0.2)), tmp_path / "two", ranks=2, check=False).directory
    assert (two.path / file_names.PEAKS).read_bytes() == (both[1].path / file_names.PEAKS).read_bytes()


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
def test_a_run_that_was_killed_goes_on_to_the_same_peaks_and_snapshots(both, tmp_path):
    _, whole = both
    shutil.copy(whole.path / file_names.SCENE, tmp_path)
    with subprocess.Popen([sys.executable, "-c", KILLED], cwd=tmp_path, stdin=subprocess.PIPE) as process:
        assert process.wait(HANGS) == -signal.SIGKILL
    assert not (tmp_path / "cut" / file_names.PEAKS).exists()
    again = resume(tmp_path / "cut", check=False)
    assert again.directory.job.resumed[0].from_step > 0
    assert (tmp_path / "cut" / file_names.PEAKS).read_bytes() == (whole.path / file_names.PEAKS).read_bytes()
    velocity = [np.concatenate([block.velocity for block in part.snapshots()]) for part in (whole, again.directory)]
    assert np.array_equal(*velocity)


@pytest.mark.parametrize("first_only", [True, False])
def test_a_finder_goes_on_from_the_state_of_another(first_only):
    trajectory = engine.run(long_scene(every=0.2).problem())
    pieces = list(blocks(trajectory))
    pieces = [pieces[0], *(trajectory[k : k + 50] for k in range(pieces[0].frames, trajectory.frames, 50))]
    one, other = PeakFinder(first_only=first_only), PeakFinder(first_only=first_only)
    for piece in pieces:
        one.add(piece)
        other.add(piece)
        other = PeakFinder(first_only=first_only).resumed(piece.problem, other.state())
    found, expected = other.result(), one.result()
    assert len(found) > 50
    assert np.array_equal(found.time, expected.time)
    assert np.array_equal(found.velocity, expected.velocity)
