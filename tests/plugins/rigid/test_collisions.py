"""Rigid beads against eqs 3-5, exact orbits and an independent integration; what every collision keeps."""

import math

import numpy as np
import pytest
from plain_scene import scene
from scipy.linalg import expm
from small_problems import rigid_problem

from analysis.trajectory import joined
from lammps_inputs import physics
from lammps_inputs.limits import closing
from workflow.plugins.rigid.engine import blocks, run, sample

ABOVE = 1.0 + 4.0 * np.finfo(float).eps


def random_kicks(chains, beads, seed):
    random = np.random.default_rng(seed)
    v = random.choice([-1.0, 1.0], (chains, beads)) * random.uniform(0.2, 1.0, (chains, beads))
    v /= np.abs(v).max()
    return [(c + 1, b + 1, float(v[c, b])) for c in range(chains) for b in range(beads)]


def energies(t):
    spring = 0.5 * physics.kappa(t.problem.system) * np.diff(t.displacement, axis=1) ** 2
    return np.array(
        [math.fsum((0.5 * v**2).ravel()) + math.fsum(u.ravel()) for v, u in zip(t.velocity, spring, strict=True)]
    )


def momenta(t):
    return np.array([math.fsum(v.ravel()) for v in t.velocity])


# --- eqs 3-5 of the paper, and the engine's row against them ---------------------------------------------------------


def first_row(chains=2, kicks=((1, 1, 1.0),), kappa=0.1, gap=100.0):
    return rigid_problem(chains, 2, kicks, kappa, gap, duration=80.0)


TIMES = np.linspace(0.0, 80.0, 1001)


def eq_3(problem):
    """Matrix of the rate of displacements and velocities [x and v of each chain] of a row."""
    chains = problem.chains
    lateral = np.diag(np.full(chains - 1, 1.0), 1) + np.diag(np.full(chains - 1, 1.0), -1)
    springs = physics.kappa(problem.system) * (lateral - np.diag(lateral.sum(axis=0)))
    return np.block([[np.zeros((chains, chains)), np.eye(chains)], [springs, np.zeros((chains, chains))]])


def at_start(problem):
    """[x and v of each chain, row]."""
    return np.vstack([np.zeros((problem.chains, problem.beads)), physics.initial_velocity(problem.system)])


@pytest.mark.slow
@pytest.mark.parametrize("kappa", [0.01, 0.1, 1.0])
def test_two_chains_move_by_eq_4(kappa):
    omega = math.sqrt(2.0 * kappa)
    row = sample(run(first_row(kappa=kappa)), TIMES)
    swing, cos = np.sin(omega * TIMES) / omega, np.cos(omega * TIMES)
    x, v = np.stack([TIMES + swing, TIMES - swing], axis=1), np.stack([1.0 + cos, 1.0 - cos], axis=1)
    np.testing.assert_allclose(row.displacement[:, :, 0], 0.5 * x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(row.velocity[:, :, 0], 0.5 * v, rtol=0, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("chains", [1, 3, 20])
@pytest.mark.parametrize("kappa", [0.0, 0.3])
def test_any_number_of_chains_moves_by_its_modes(chains, kappa):
    problem = first_row(chains, ((1, 1, 1.0), (chains, 1, 0.3))[: min(chains, 2)], kappa)
    row = sample(run(problem), TIMES[::50])
    for time, x, v in zip(row.time, row.displacement, row.velocity, strict=True):
        exact = expm(time * eq_3(problem)) @ at_start(problem)
        # of displacements to 80, rounded by eps times the norm of the matrix, which is below 100
        np.testing.assert_allclose(np.concatenate([x, v]), exact, rtol=0, atol=2e-12)


@pytest.mark.slow
@pytest.mark.parametrize("kappa", [0.1, 1.0])
def test_the_gap_of_eq_5_closes_in_a_quarter_period(kappa):
    gap = closing.gap_of_eq_5(kappa)
    problem = first_row(kappa=kappa, gap=gap)
    omega = math.sqrt(2.0 * kappa)
    assert closing.theta(kappa, gap) == pytest.approx(1.2854, abs=5e-5)
    assert closing.theta(kappa, gap) == pytest.approx(closing.THETA_OF_EQ_5, rel=1e-15)
    x, v = np.split((expm(math.pi / 2.0 / omega * eq_3(problem)) @ at_start(problem))[:, 0], 2)
    assert x[0] == pytest.approx(gap, rel=1e-14)
    # the sentence after eq. 5 asks for equal displacements too: chain 2 has gone (pi - 2) / (pi + 2) of the gap
    assert x[1] / gap == pytest.approx((math.pi - 2.0) / (math.pi + 2.0), rel=1e-14)
    np.testing.assert_allclose(v, [0.5, 0.5], atol=1e-15)


# --- what the paper's scenes do ---------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("kappa", [0.1, 1.0])
def test_at_the_gap_of_eq_5_chain_2_collides_after_half_a_period_with_three_quarters_against_one(kappa):
    found = run(rigid_problem(kappa=kappa, gap=closing.gap_of_eq_5(kappa), duration=50.0), max_events=2)
    assert list(zip(found.chain, found.row, strict=True)) == [(1, 1), (2, 1)]
    np.testing.assert_allclose(math.sqrt(2.0 * kappa) * found.time, [math.pi / 2.0, math.pi], rtol=1e-14)
    np.testing.assert_allclose(found.striker, [0.5, 0.75], rtol=1e-14)
    np.testing.assert_allclose(found.target, [0.0, 0.25], rtol=0, atol=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize(("n", "kappa"), [(1, 0.1), (2, 0.5), (3, 3.0), (4, 0.1)])
def test_theta_of_n_quarter_turns_loses_nothing_in_100_rows(n, kappa):
    """n odd hops chains at every row, n even stays in chain 1."""
    omega = math.sqrt(2.0 * kappa)
    gap = n * math.pi / 2.0 / omega * ABOVE
    found = run(rigid_problem(beads=110, kappa=kappa, gap=gap, duration=110 * n * math.pi / omega), max_events=100)
    rows = np.arange(1, 101)
    assert np.array_equal(found.row, rows)
    assert np.array_equal(found.chain, np.where(rows % 2, 1 + n % 2, 1))
    np.testing.assert_allclose(found.striker, 1.0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.target, 0.0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.time * omega, n * math.pi * rows, rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("below", [1e-4, 1e-12])
def test_the_loss_free_orbits_are_lost_within_20_rows_from_below(below):
    """There the other bead arrives a little before; a deviation e of one row is about e**(2/3) in the next."""
    found = run(rigid_problem(beads=110, gap=math.pi / 2.0 * (1.0 - below), duration=200.0))
    assert np.abs(found.striker[found.row == 20] - 1.0).min() > 0.01


@pytest.mark.slow
def test_a_small_gap_costs_theta_squared_over_two_of_the_energy_a_row():
    theta = 1e-3
    found = run(rigid_problem(beads=102, gap=theta, duration=1.0))
    first = [np.flatnonzero((found.row == row) & (found.chain == 1))[0] for row in range(1, 101)]
    rows = np.arange(1, 101)
    # bead n + 1 leaves with v**2 = 1 - theta**2 n / 2, and what is left out is about theta**4 n / 48
    np.testing.assert_allclose(found.striker[first] ** 2, 1.0 - theta**2 * rows / 2.0, rtol=0, atol=1e-11)


def of_gaps(gaps, **changes):
    """Collisions of one chain with a gap for each contact."""
    return run(scene(chains=1, coupling=None, **{"beads": 6, "gap": gaps, "duration": 8.0, **changes}).problem())


@pytest.mark.slow
def test_beads_collide_after_the_sums_of_their_gaps():
    gaps = (0.3, 0.1, 0.2, 0.5, 0.4)
    found = of_gaps(gaps)
    np.testing.assert_allclose(found.time, np.cumsum(gaps), rtol=1e-15)
    np.testing.assert_array_equal(found.row, [1, 2, 3, 4, 5])
    assert np.all(found.striker == 1.0)


@pytest.mark.slow
def test_beads_kicked_towards_each_other_exchange_velocities_where_their_paths_cross():
    kicks = [{"bead": 1, "velocity": 1.0}, {"bead": 3, "velocity": -0.5}]
    found = of_gaps([0.3, 0.5], beads=3, kick=kicks, duration=1.0)
    # bead 1 meets bead 2 at 0.3; bead 2, then of velocity 1, is 0.35 from bead 3, which approaches with 0.5
    np.testing.assert_allclose(found.time[:2], [0.3, 0.3 + 0.35 / 1.5], rtol=1e-15)
    np.testing.assert_allclose(found.impulse[:2], [1.0, 1.5], rtol=1e-15)


# --- an independent integration ---------------------------------------------------------------------------------------


def at_once(event):
    """Mirror images collide at one instant, in any order."""
    return round(event[0], 7), event[1]


def brute_force(problem, events, step=2e-3):
    """Fine steps of the whole row's matrix exponential, with bisection of the first overlap of closing beads."""
    chains, matrix, state = problem.chains, eq_3(problem), at_start(problem)
    whole = expm(step * matrix)

    def meeting(state):
        closing = -np.diff(state, axis=1)
        return (closing[:chains] >= physics.gap(problem.system)) & (closing[chains:] > 0.0)

    time, found = 0.0, []
    while len(found) < events:
        after = whole @ state
        if not meeting(after).any():
            state, time = after, time + step
            continue
        low, high = 0.0, step
        for _ in range(44):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if meeting(expm(middle * matrix) @ state).any() else (middle, high)
        state, time = expm(high * matrix) @ state, time + high
        for chain, bead in np.argwhere(meeting(state)):
            pair = state[chains + chain, bead : bead + 2]
            found.append((time, chain + 1, bead + 1, *pair))
            pair[:] = pair[::-1].copy()
    return [np.array(column) for column in zip(*sorted(found[:events], key=at_once), strict=True)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("chains", "kappa", "gap", "kicks"),
    [
        (2, 1.0, 0.4, [(1, 1, 1.0), (2, 3, -0.7)]),
        (2, 0.5, 5.0, [(1, 1, 1.0), (2, 2, -0.4), (1, 6, -0.9)]),
        (4, 2.0, 0.6, [(1, 1, 1.0), (4, 2, 0.3), (2, 6, -0.8)]),
    ],
)
def test_the_first_events_agree_with_fine_steps_and_bisection(chains, kappa, gap, kicks):
    problem = rigid_problem(chains, 6, kicks, kappa, gap, 200.0)
    count = 8
    found = run(problem, max_events=count)
    time, chain, row, striker, target = brute_force(problem, count)
    order = np.lexsort((found.chain, np.round(found.time, 7)))
    np.testing.assert_allclose(found.time[order], time, rtol=0, atol=1e-9)
    assert np.array_equal(found.chain[order], chain)
    assert np.array_equal(found.row[order], row)
    np.testing.assert_allclose(found.striker[order], striker, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.target[order], target, rtol=0, atol=1e-9)


# --- what is conserved ------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_many_collisions_keep_energy_and_momentum():
    problem = rigid_problem(2, 2000, random_kicks(2, 2000, 1), gap=1.0, duration=4000.0)
    found = run(problem, max_events=200_000)
    assert len(found) == 200_000
    t = sample(found, np.linspace(0.0, found.until, 5))
    np.testing.assert_allclose(energies(t), physics.energy(problem.system), rtol=1e-12)
    rounding = np.finfo(float).eps * np.abs(t.velocity[0]).sum()
    np.testing.assert_allclose(momenta(t), physics.momentum(problem.system), rtol=0, atol=rounding)
    assert np.all(found.impulse > 0.0)
    assert np.all(np.diff(found.time) >= 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(("chains", "gap"), [(1, 0.3), (2, 1e-3), (3, 10.0), (5, 0.3)])
def test_beads_never_overlap(chains, gap):
    problem = rigid_problem(chains, 40, random_kicks(chains, 40, 2), kappa=0.4, gap=gap, duration=40.0)
    found = run(problem, max_events=20_000)
    assert len(found) > 10
    times = np.unique(np.concatenate([found.time[:2000], np.linspace(0.0, found.until, 500)]))
    t = sample(found, times)
    overlap = -np.diff(t.displacement, axis=2) - gap
    assert overlap.max() < 1e-13 * max(1.0, found.until)
    np.testing.assert_allclose(energies(t), physics.energy(problem.system), rtol=1e-13)


@pytest.mark.slow
def test_the_scale_of_time_and_length_does_not_matter():
    """Rigid dynamics depend on theta alone."""
    kicks = random_kicks(2, 20, 3)
    soft = run(rigid_problem(2, 20, kicks, kappa=0.5, gap=1.0, duration=20.0), max_events=30)
    stiff = run(rigid_problem(2, 20, kicks, kappa=0.5e6, gap=1e-3, duration=0.02), max_events=30)
    np.testing.assert_allclose(stiff.time, 1e-3 * soft.time, rtol=1e-9)
    np.testing.assert_allclose(stiff.striker, soft.striker, rtol=0, atol=1e-9)
    assert np.array_equal(stiff.row, soft.row)


# --- sampling ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_trajectory_has_the_frames_and_beads_of_the_problem():
    t = joined(blocks(run(rigid_problem(3, 30, recorded=(1, 7, 30), duration=50.0))))
    np.testing.assert_allclose(t.time, np.linspace(0.0, 50.0, 101))
    whole = joined(blocks(run(rigid_problem(3, 30, duration=50.0))))
    assert np.array_equal(t.velocity, whole.velocity[:, :, [0, 6, 29]])


@pytest.mark.slow
def test_times_may_come_in_any_order_and_hold_the_velocities_after_a_collision():
    found = run(rigid_problem(duration=50.0))
    times = np.random.default_rng(5).permutation(np.concatenate([found.time, np.linspace(0.0, 50.0, 77)]))
    mixed, sorted_ = sample(found, times), sample(found, np.sort(times))
    assert np.array_equal(mixed.velocity[np.argsort(times)], sorted_.velocity)
    after = sample(found, found.time[:1]).velocity[0, 0]
    assert (after[0], after[1]) == (found.target[0], found.striker[0])
