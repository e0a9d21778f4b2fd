"""Eqs 3-5 of the paper, and the engine's row against them."""

import math

import numpy as np
import pytest
from small_problems import problem

from lammps_inputs import physics
from workflow.engines.collisions import modes, run, sample


def make_problem(chains=2, kicks=((1, 1, 1.0),), kappa=0.1, gap=100.0, duration=80.0):
    times = {"timestep": duration, "steps_per_frame": 1, "frames": 1}
    return problem(chains=chains, beads=2, kicks=kicks, kappa=kappa, gap=gap, **times)


TIMES = np.linspace(0.0, 80.0, 1001)


@pytest.mark.parametrize("kappa", [0.01, 0.1, 1.0])
def test_two_chains_move_by_eq_4(kappa):
    omega = math.sqrt(2.0 * kappa)
    problem = make_problem(kappa=kappa)
    x, v = modes.motion(problem, TIMES)
    swing = np.sin(omega * TIMES) / omega
    np.testing.assert_allclose(x, 0.5 * np.stack([TIMES + swing, TIMES - swing], axis=1), rtol=0, atol=5e-14)
    cos = np.cos(omega * TIMES)
    np.testing.assert_allclose(v, 0.5 * np.stack([1.0 + cos, 1.0 - cos], axis=1), rtol=0, atol=5e-14)
    row = sample(run(problem), TIMES)
    np.testing.assert_allclose(row.displacement[:, :, 0], x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(row.velocity[:, :, 0], v, rtol=0, atol=1e-12)


@pytest.mark.parametrize("chains", [1, 3, 4, 7, 20])
@pytest.mark.parametrize("kappa", [0.0, 0.3])
def test_any_number_of_chains_moves_by_its_modes(chains, kappa):
    problem = make_problem(chains, ((1, 1, 1.0), (chains, 1, 0.3))[: min(chains, 2)], kappa)
    x, v = modes.motion(problem, TIMES)
    row = sample(run(problem), TIMES)
    np.testing.assert_allclose(row.displacement[:, :, 0], x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(row.velocity[:, :, 0], v, rtol=0, atol=1e-12)


def test_the_modes_solve_eq_3():
    problem = make_problem(5)
    h = 1e-3
    t = np.arange(0.0, 20.0, h)
    x, v = modes.motion(problem, t)
    springs = np.diff(x, axis=1, prepend=x[:, :1], append=x[:, -1:])
    force = physics.kappa(problem.system) * np.diff(springs, axis=1)
    np.testing.assert_allclose(np.diff(x, axis=0) / h, 0.5 * (v[1:] + v[:-1]), rtol=0, atol=1e-7)
    np.testing.assert_allclose(np.diff(v, axis=0) / h, 0.5 * (force[1:] + force[:-1]), rtol=0, atol=1e-7)


@pytest.mark.parametrize("kappa", [0.1, 1.0])
def test_the_gap_of_eq_5_closes_in_a_quarter_period(kappa):
    gap = modes.gap_of_eq_5(kappa)
    problem = make_problem(kappa=kappa, gap=gap)
    omega = math.sqrt(2.0 * kappa)
    assert modes.theta(problem) == pytest.approx(1.2854, abs=5e-5)
    assert modes.theta(problem) == pytest.approx(modes.THETA_OF_EQ_5, rel=1e-15)
    (x,), (v,) = modes.motion(problem, np.array([math.pi / 2.0 / omega]))
    assert x[0] == pytest.approx(gap, rel=1e-14)
    # the sentence after eq. 5 asks for equal displacements too: chain 2 has gone (pi - 2) / (pi + 2) of the gap
    assert x[1] / gap == pytest.approx((math.pi - 2.0) / (math.pi + 2.0), rel=1e-14)
    np.testing.assert_allclose(v, [0.5, 0.5], atol=1e-15)


def test_eq_5_needs_springs():
    with pytest.raises(ValueError, match="springs"):
        modes.gap_of_eq_5(0.0)
