"""Beads that are pushed, in the reference: momentum and energy to the last digit, orders, and known limits."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from small_problems import problem

from analysis import motion
from analysis.conservation import Conservation
from lammps_inputs.laws.in_time import HalfSine, Rectangular, make_table
from lammps_inputs.loads import Load
from workflow.engines.reference import engine
from workflow.engines.reference.energy_exchange import Accountant
from workflow.engines.reference.passages import passages
from workflow.engines.reference.schemes import VERLET

LAWS = {
    "half-sine": HalfSine(0.8, 2.03),
    "rectangular": Rectangular(0.5, 2.03),
    "table": make_table(np.array([0.3, 0.7, 1.5, 2.1]), np.array([0.0, 0.9, -0.2, 0.0])),
}


def pushed(*loads, **changes):
    return problem(kicks=(), loads=loads, **changes)


@pytest.mark.slow
def test_it_is_the_solution_that_scipy_finds():
    one = pushed(Load(1, 1, LAWS["rectangular"]), Load(2, 3, HalfSine(-0.2, 1.0)), frames=60)
    shape = (one.chains, one.beads)

    def slope(t, state):
        x, v = state.reshape(2, *shape)
        return np.concatenate([v, motion.acceleration(one.system, x, time=np.float64(t))], axis=None)

    state, times = np.zeros(2 * one.chains * one.beads), np.arange(one.frames + 1) * one.every
    kinks = sorted({0.0, *(kink for load in one.system.loads for kink in load.law.kinks), times[-1]})
    found = np.empty((len(times), len(state)))
    for begin, end in itertools.pairwise(kinks):
        inside = np.flatnonzero((times >= begin) & (times <= end))
        # the force on the right of its end is none, so the solver stays a little before it
        solved = solve_ivp(
            slope, (begin, np.nextafter(end, 0.0)), state, "DOP853", np.minimum(times[inside], np.nextafter(end, 0.0)),
            rtol=1e-12, atol=1e-13, dense_output=True,
        )  # fmt: skip
        found[inside] = solved.y.T
        state = solved.sol(np.nextafter(end, 0.0))
    right = found.reshape(len(times), 2, *shape)[:, 1]
    run = engine.run(one, steps_per_frame=64)
    assert np.max(np.abs(run.velocity - right)) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_momentum_afterwards_is_the_impulse_and_energy_the_work(name):
    one = pushed(Load(1, 1, LAWS[name]), Load(1, 1, HalfSine(0.3, 1.05)))
    run, seen = engine.run(one, steps_per_frame=20), Conservation()
    for begin in range(0, run.frames, 7):
        seen.add(run[begin : begin + 7])
    given = sum(load.impulse(load.end) for load in one.system.loads)
    assert abs(run.velocity[-1].sum() - given) < 1e-13
    assert seen.momentum_drift < 1e-13
    assert seen.energy_drift < 2e-6  # contacts close and open between frames


@pytest.mark.slow
@pytest.mark.parametrize("name", ["half-sine", "table"])
def test_stepping_as_lammps_does_is_of_order_two_and_gives_the_impulse_exactly(name):
    one = pushed(Load(1, 1, LAWS[name]), frames=60)
    right = engine.run(one, steps_per_frame=64).velocity
    errors = []
    for steps in (4, 8, 16, 32):
        run = engine.run(one, steps_per_frame=steps, scheme=VERLET)
        errors.append(np.max(np.abs(run.velocity - right)))
        assert abs(run.velocity[-1].sum() - one.system.loads[0].impulse(99.0)) < 1e-12
    order = np.polyfit(np.log([4, 8, 16, 32]), -np.log(errors), 1)[0]
    assert 1.95 < order < 2.05


@pytest.mark.slow
def test_a_force_that_ends_at_a_frame_leaves_order_one_there_and_two_afterwards():
    one = pushed(Load(1, 1, Rectangular(0.5, 2.0)), frames=60)
    right = engine.run(one, steps_per_frame=64).velocity
    errors = [
        np.max(np.abs(engine.run(one, steps_per_frame=steps, scheme=VERLET).velocity - right), axis=(1, 2))
        for steps in (8, 16)
    ]
    assert errors[0][20] / errors[1][20] == pytest.approx(2.0, rel=0.05)
    assert errors[0][20] == pytest.approx(0.5 * one.every / 8 / 4, rel=0.05)
    assert np.max(errors[0][21:]) / np.max(errors[1][21:]) == pytest.approx(4.0, rel=0.1)


@pytest.mark.slow
def test_a_very_short_push_tends_to_the_kick_in_proportion_to_its_duration():
    kicked = passages(problem(chains=1, beads=60, frames=700), timestep=0.02).waves
    away = []
    for duration in (0.4, 0.2, 0.1, 0.05):
        load = Load(1, 1, Rectangular(1.0 / duration, duration))
        waves = passages(pushed(load, chains=1, beads=60, frames=700), timestep=0.02).waves
        away.append(kicked.at(50).peak_velocity[0] - waves.at(50).peak_velocity[0])
    assert kicked.at(50).peak_velocity[0] == pytest.approx(0.68163, abs=1e-5)
    assert 0.0 < away[3] < 0.01
    assert np.all(np.diff(np.log2(away)) < -0.9)


@pytest.mark.slow
def test_the_work_on_frames_is_that_on_their_own_motion():
    """A bead that leaves its chain on a spring: the same push does 2% more on a motion that is 2% larger."""
    one = pushed(Load(1, 8, HalfSine(0.8, 2.03)), steps_per_frame=50, frames=6)
    own = engine.run(one)
    larger = replace(own, displacement=1.02 * own.displacement, velocity=1.02 * own.velocity, exchange=None)
    found = Accountant(one).of(larger).exchange[:, -1]
    assert own.exchange[-1, -1] > 0.4
    np.testing.assert_allclose(found, 1.02 * own.exchange[:, -1], rtol=2e-4, atol=1e-15)


def test_nothing_moves_that_the_push_has_not_reached():
    one = pushed(Load(1, 20, HalfSine(0.8, 2.0)), chains=1, beads=40, frames=50)
    whole = engine.run(one)
    narrow = engine.run(one, window=34)
    np.testing.assert_array_equal(whole.velocity, narrow.velocity)
    assert not whole.velocity[10, 0, 35:].any()


@pytest.mark.slow
def test_no_load_leaves_the_bits_of_a_kicked_run():
    one = problem()
    later = Load(2, 5, make_table(np.array([90.0, 91.0, 92.0]), np.array([0.0, 1.0, 0.0])))
    never = replace(one, system=replace(one.system, loads=(later,)))
    np.testing.assert_array_equal(
        engine.run(one, steps_per_frame=4).velocity, engine.run(never, steps_per_frame=4).velocity
    )
