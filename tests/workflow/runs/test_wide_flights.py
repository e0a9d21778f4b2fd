"""Beads that fly far from where they were: every way to run a scene keeps their contacts and springs."""

import random
from contextlib import suppress

import lammps_here
import numpy as np
import pytest
from random_scenes import draw
from stock_lammps import scene
from truth import Truth

from lammps_inputs import Kick
from workflow.engines.lammps import mpi
from workflow.runs.resume import resume
from workflow.runs.run import run

TWO = pytest.mark.skipif(mpi.cores() < 2, reason="needs two cores")


def is_within_its_stated_error(done):
    """Every frame is there, and the beads' velocities are as near the exact ones as the run states."""
    found, check = done.trajectory, done.check
    assert found.frames == found.problem.frames + 1
    exact = Truth(done.directory.scene, found.problem.duration, 1e-12).states(found.time)[1]
    off = np.abs(found.velocity - exact[:, :, found.beads - 1])
    assert off.max() < max(1e-5, check.velocity + check.reference.velocity)


@pytest.mark.slow
def test_contacts_are_not_lost_between_two_segments_of_a_composition(tmp_path):
    kicks = tuple(Kick(bead=bead, velocity=velocity) for bead, velocity in ((1, 0.2), (2, 1.0), (3, 1.0)))
    case = scene(beads=12, gap=15.0, kick=kicks, duration=253.0, every=0.5, scheme="suzuki4")
    is_within_its_stated_error(run(case, tmp_path / "run", lammps=lammps_here.run))


@pytest.mark.slow
@TWO
def test_springs_are_not_lost_on_two_ranks_of_a_composition(tmp_path):
    case = scene(chains=2, beads=3, kappa=0.0018, kick=(Kick(bead=2, velocity=1.0),), duration=20.0, scheme="suzuki4")
    one, two = (run(case, tmp_path / str(ranks), ranks=ranks, check=False).trajectory for ranks in (1, 2))
    np.testing.assert_array_equal(one.velocity, two.velocity)


def drawn(seed):
    """The first scene of a seed that is accepted."""
    chance, found = random.Random(seed), None
    while found is None:
        with suppress(ValueError):
            found = draw(chance, seed)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [12, 15, 28, 39])  # gaps; a window, a push, springs and walls
def test_random_scenes_are_not_silently_wrong(seed, tmp_path):
    if seed % 2:
        done = run(drawn(seed), tmp_path / "run", lammps=lammps_here.run)
    else:
        cut = run(drawn(seed), tmp_path / "run", lammps=lammps_here.interrupted_after(0))
        done = resume(tmp_path / "run", lammps=lammps_here.run) if cut.outcome == "interrupted" else cut
    is_within_its_stated_error(done)


@pytest.mark.slow
@TWO
def test_what_one_rank_can_do_two_can_also_when_they_go_on_from_it(tmp_path):
    case = drawn(8)  # walls, springs, suzuki4
    one = run(case, tmp_path / "one", lammps=lammps_here.run, check=False).trajectory
    two = run(case, tmp_path / "two", ranks=2, check=False).trajectory
    assert run(case, tmp_path / "on", lammps=lammps_here.interrupted_after(0), check=False).outcome == "interrupted"
    on = resume(tmp_path / "on", ranks=2, check=False).trajectory
    for other in (two, on):
        np.testing.assert_array_equal(other.velocity, one.velocity)
        np.testing.assert_array_equal(other.displacement, one.displacement)
