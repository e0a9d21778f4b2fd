"""What tells whether two runs are the same: every number, which bead it is of, and which file it stands in."""

import hashlib
import os
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem

from analysis.trajectory import Trajectory, joined
from lammps_inputs import Kick, Scene
from workflow.runs.run import run
from workflow.runs.run_directory import add_frames


def digest(block):
    found = hashlib.sha256()
    add_frames(found, block)
    return found.hexdigest()


@pytest.mark.parametrize("name", ["displacement", "velocity"])
def test_a_fingerprint_tells_of_every_displacement_and_velocity_and_where_a_window_is(name):
    number = np.arange(128.0).reshape(1, 2, 64)
    what = problem(beads=100, window=64, frames=1)
    one, other = (Trajectory(what, np.zeros(1), 0.001 * number, 0.5 + number, first=1) for _ in range(2))
    numbers = getattr(other, name)
    assert digest(one) == digest(other) != digest(replace(one, first=2))
    numbers[0, 1, 3] = np.nextafter(numbers[0, 1, 3], np.inf)
    assert digest(other) != digest(one)


def test_frames_are_read_again_where_their_file_has_changed(tmp_path):
    scene = Scene(name="small", chains=1, beads=8, kick=Kick(velocity=1.0), duration=3.0)
    directory = run(scene, tmp_path / "run", engine="reference").directory
    assert joined(directory.blocks()).velocity is joined(directory.blocks()).velocity
    content = bytearray(directory.dump.read_bytes())
    number = np.frombuffer(content, "<f8", count=1, offset=len(content) - 8)  # velocity of the last bead
    number[0] = 0.25
    directory.dump.write_bytes(content)
    os.utime(directory.dump, ns=(0, 0))  # a clock may be coarse
    assert joined(directory.blocks()).velocity[-1, -1, -1] == 0.25
