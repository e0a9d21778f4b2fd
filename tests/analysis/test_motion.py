"""The equation of motion on recorded states, against differences of energies and of trajectories."""

import numpy as np
import pytest
from stock_lammps import scene

from analysis import motion
from analysis.trajectory import Trajectory
from workflow.engines.reference.engine import run

SHAPES = [(1, None, 0.0), (2, 0.1, 0.0), (3, 0.5, 0.0), (2, 0.1, 0.3)]


def problem(chains=2, kappa=0.1, gap=0.0, **changes):
    return scene(**{"chains": chains, "beads": 9, "kappa": kappa, "gap": gap, "duration": 6.0, **changes}).problem()


def everywhere(trajectory):
    """Acceleration and its rate of every bead at every frame."""
    return motion.acceleration_and_rate(trajectory, *np.indices(trajectory.velocity.shape))


def random_state(like, seed=1):
    """Beads up to 0.6 apart or pressed together."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-0.3, 0.3, (1, like.chains, like.beads))
    return Trajectory(like, np.zeros(1), x, rng.uniform(-1, 1, x.shape))


@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
def test_acceleration_is_minus_the_slope_of_the_energy(chains, kappa, gap):
    state = random_state(problem(chains, kappa, gap))
    x, v, like = state.displacement[0], state.velocity[0], state.problem
    acceleration = everywhere(state)[0][0]
    h = 1e-5
    for place in np.ndindex(x.shape):
        shift = np.zeros_like(x)
        shift[place] = h
        slope = (motion.energy(like.system, x + shift, v) - motion.energy(like.system, x - shift, v)) / (2 * h)
        # the third derivative of 2/5 r^2.5 is below r^-0.5: 3 h^1.5 at an opening contact, and rounding 10 eps / h
        assert -slope == pytest.approx(acceleration[place], abs=3 * h**1.5 + 2e-10)


@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
def test_acceleration_is_the_slope_of_recorded_velocities(chains, kappa, gap):
    h = 0.01
    found = run(problem(chains, kappa, gap, every=h), steps_per_frame=4)
    slope = (found.velocity[2:] - found.velocity[:-2]) / (2 * h)
    # a third derivative of v is below 4 between contacts, and (jump of a's rate like r^0.5) h^1.5 where one opens
    assert np.abs(slope - everywhere(found)[0][1:-1]).max() < h**1.5


@pytest.mark.parametrize(("chains", "kappa", "gap"), SHAPES)
def test_the_rate_is_the_slope_of_the_acceleration(chains, kappa, gap):
    h = 0.01
    acceleration, rate = everywhere(run(problem(chains, kappa, gap, every=h), steps_per_frame=4))
    slope = (acceleration[2:] - acceleration[:-2]) / (2 * h)
    # the rate goes like r^0.5 at an opening contact: h^0.5 there, at speeds up to 1 and a slope of 3/2
    assert np.abs(slope - rate[1:-1]).max() < 1.5 * h**0.5
    assert np.median(np.abs(slope - rate[1:-1])) < h**2


def test_the_energy_of_one_contact_and_one_spring_is_their_sum():
    x = np.zeros((2, 9))
    x[0, 8] = -0.5  # presses on bead 8, and stretches its spring
    assert motion.energy(problem().system, x, np.zeros((2, 9))) == pytest.approx(
        0.4 * 0.5**2.5 + 0.05 * 0.25, rel=1e-15
    )


def test_in_a_ring_the_last_force_is_that_of_the_contact_that_closes_it():
    closed = scene(chains=1, beads=6, periodic=True).problem().system
    overlap = np.arange(6.0)[np.newaxis]
    np.testing.assert_allclose(motion.contact_force(closed, overlap), overlap**1.5, rtol=1e-15)


def test_the_participation_number_is_one_over_the_sum_of_squared_shares_of_the_beads_energies():
    assert motion.participation(np.array([[0.0, 2.0, 2.0], [2.0, 0.0, 2.0]])) == pytest.approx(4.0, rel=1e-14)
    assert motion.participation(np.array([3.0, 1.0])) == pytest.approx(1.6, rel=1e-14)
    assert np.isnan(motion.participation(np.zeros(3)))


@pytest.mark.parametrize(("first", "last"), [(1, 4), (4, 7), (6, 9), (1, 9)])
def test_a_part_of_a_chain_has_the_walls_of_its_beads_alone(first, last):
    walled = problem(walls={"left": "bead", "right": "rigid"}, damping={"contact": 0.3})
    plain = problem(damping={"contact": 0.3})
    state, part = random_state(walled), (Ellipsis, slice(first - 1, last))
    x, v = 2.0 * state.displacement, state.velocity

    def at_walls(x, v, first=1):
        """Accelerations, energies of beads and all energy with the walls, less those without."""
        with_walls, without = (
            (
                motion.acceleration(each.system, x, first, velocity=v)[0],
                motion.bead_energy(each.system, x, v, first)[0],
                motion.energy(each.system, x, v, first)[0],
            )
            for each in (walled, plain)
        )
        return [one - other for one, other in zip(with_walls, without, strict=True)]

    of_all, (acceleration, energies, energy) = at_walls(x, v), at_walls(x[part], v[part], first)
    for found, whole in zip((acceleration, energies), of_all[:2], strict=True):
        np.testing.assert_allclose(found, whole[part], atol=1e-14)
        assert np.any(whole[:, [0, -1]] != 0.0)
    assert energy == pytest.approx(energies.sum(), abs=1e-14)
