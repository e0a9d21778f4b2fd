"""Beads that are pushed, in the reference: momentum and energy to the last digit, orders, and known limits."""

from dataclasses import replace

import numpy as np
import pytest
from plain_scene import scene
from small_problems import problem
from truth import Truth

from analysis.conservation import ConservationMeter
from lammps_inputs.laws.in_time import half_sine, rectangular
from lammps_inputs.loads import Load
from workflow.engines.reference import engine
from workflow.engines.reference.energy_exchange import Accountant
from workflow.engines.reference.engine import passages
from workflow.engines.reference.kernel_inputs import make_terms
from workflow.engines.reference.schemes import VERLET


def pushed(*loads, **changes):
    return problem(kicks=(), loads=loads, **changes)


@pytest.mark.slow
def test_a_push_that_ends_abruptly_gives_the_exact_motion_and_its_impulse():
    one = scene(kick=None, push={"peak": 0.5, "duration": 2.03, "shape": "rectangular"})
    run = engine.run(one.problem(), steps_per_frame=320)
    exact = Truth(one, run.time[-1], 1e-13).states(run.time)[1]
    assert np.max(np.abs(run.velocity - exact)) < 1e-9
    (push,) = run.problem.system.loads
    assert abs(run.velocity[-1].sum() - push.impulse(push.end)) < 1e-13
    assert ConservationMeter(run.problem).read([run]).momentum_drift < 1e-13


@pytest.mark.slow
def test_a_force_that_ends_at_a_frame_leaves_order_one_there_and_two_afterwards():
    one = pushed(Load(1, 1, rectangular(0.5, 2.0)), frames=60)
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
    def peak(what):
        waves = passages(what, timestep=0.02)
        return waves.peak_velocity[waves.bead == 50][0]

    kicked, away = peak(problem(chains=1, beads=60, frames=700)), []
    for duration in (0.4, 0.2, 0.1, 0.05):
        load = Load(1, 1, rectangular(1.0 / duration, duration))
        away.append(kicked - peak(pushed(load, chains=1, beads=60, frames=700)))
    assert kicked == pytest.approx(0.68163, abs=1e-5)
    assert 0.0 < away[3] < 0.01
    assert np.all(np.diff(np.log2(away)) < -0.9)


@pytest.mark.slow
def test_the_work_on_frames_is_that_on_their_own_motion():
    """A bead that leaves its chain on a spring: the same push does 2% more on a motion that is 2% larger."""
    one = pushed(Load(1, 8, half_sine(0.8, 2.03)), steps_per_frame=50, frames=6)
    own = engine.run(one)
    larger = replace(own, displacement=1.02 * own.displacement, velocity=1.02 * own.velocity, exchange=None)
    (counted,) = Accountant(one).counted([larger])
    found = counted.exchange[:, -1]
    assert own.exchange[-1, -1] > 0.4
    np.testing.assert_allclose(found, 1.02 * own.exchange[:, -1], rtol=2e-4, atol=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("steps_a_call", [3, 20], ids=lambda steps: f"{steps} steps a call")
def test_frames_are_the_same_bit_for_bit_however_many_steps_a_call_takes(steps_a_call, monkeypatch):
    """Seven steps a frame, while a force acts: parts of a frame in a call, or two frames."""
    one = pushed(Load(1, 1, half_sine(0.5, 3.0)), frames=40)
    whole = engine.run(one, steps_per_frame=7)
    monkeypatch.setattr(engine.IntegratorState, "steps_a_call", lambda *_: steps_a_call)
    parts = engine.run(one, steps_per_frame=7)
    for name in ("displacement", "velocity", "exchange"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))


@pytest.mark.parametrize(
    ("push", "as_lammps", "counts"), [(True, False, True), (True, True, False), (False, False, False)]
)
def test_work_is_counted_by_the_reference_where_a_force_does_any(push, as_lammps, counts):
    one = pushed(Load(1, 1, half_sine(0.5, 3.0))) if push else problem()
    assert make_terms(one.system, as_lammps=as_lammps, step=one.timestep)[0].counts_work == counts


@pytest.mark.slow
@pytest.mark.parametrize("step_ratio", [2, 4])
def test_what_dashpots_take_of_a_smooth_push_has_the_order_of_the_scheme(step_ratio):
    """Contacts stay closed, so that forces are smooth; a kick fixes the total loss, a push does not."""
    loaded = {"precompression": {"force": 0.3}, "walls": {"left": "bead", "right": "bead"}}
    keys = {"chains": 1, "coupling": None, "beads": 8, "kick": None, "duration": 20.0, "output": {"every": 0.5}}
    push = {"bead": 4, "peak": 0.2, "duration": 5.0, "shape": "half-sine"}
    one = scene(**keys, **loaded, push=push, damping={"beads": 0.05, "contact": 0.05}).problem()

    def taken(steps):
        lost = ConservationMeter(one).read(list(engine.blocks(one, steps_per_frame=steps))).budget.dissipated
        return np.array([lost["contact_damping"][-1], lost["bead_damping"][-1]])

    exact = taken(128)
    order = np.log(np.abs((taken(4) - exact) / (taken(4 * step_ratio) - exact))) / np.log(step_ratio)
    np.testing.assert_allclose(order, 4.0, atol=0.2)


@pytest.mark.slow
def test_nothing_moves_that_the_push_has_not_reached():
    one = pushed(Load(1, 20, half_sine(0.8, 2.0)), chains=1, beads=40, frames=50)
    whole = engine.run(one)
    narrow = engine.run(one, rows=34)
    np.testing.assert_array_equal(whole.velocity, narrow.velocity)
    assert not whole.velocity[10, 0, 35:].any()
