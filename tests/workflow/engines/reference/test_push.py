"""Beads that are pushed, in the reference: momentum and energy to the last digit, orders, and known limits."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from plain_scene import scene
from small_problems import problem
from synthetic_waves import of_keys
from truth import Truth

from analysis.conservation import ConservationMeter
from lammps_inputs.laws.in_time import half_sine, rectangular
from lammps_inputs.loads import Load
from workflow import compiled
from workflow.engines.reference import engine, kernel
from workflow.engines.reference.energy_exchange import Accountant
from workflow.engines.reference.engine import passages
from workflow.engines.reference.schemes import VERLET


def interpreted(text):
    """A program whose steps are run by Python: a few take less time than compiling it."""
    imported = "from workflow.compiled import called_by_compiled, compiled, inlined"
    assert imported in text
    names = {}
    exec(text.replace(imported, "called_by_compiled = compiled = inlined = lambda function, **_: function"), names)
    names |= {name: value.py_func for name, value in names.items() if hasattr(value, "py_func")}
    names["uint64"] = int  # numpy 1 makes floats of an int and one of its own

    def advance(state, p, *others):
        names["advance"](state, [int(value) if isinstance(value, np.uint64) else value for value in p], *others)

    return SimpleNamespace(advance=advance)


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


def test_a_push_moves_a_bead_on_a_dashpot_and_does_work_on_it_as_the_closed_forms_say(monkeypatch):
    """It never meets the other bead; the dashpot takes what the push gives and the motion has not."""
    keys = {"damping": {"beads": 0.2}, "push": {"peak": 0.3, "duration": 30.0, "shape": "rectangular"}}
    one = of_keys(chains=1, beads=2, gap=60.0, duration=12.0, output={"every": 1.0}, **keys)
    monkeypatch.setattr(compiled, "module", interpreted)
    monkeypatch.setattr(kernel, "make_program", kernel.make_program.__wrapped__)
    run = engine.run(one, steps_per_frame=4)
    ((push,), (drag,)) = one.system.loads, one.system.dampers
    force, rate, t = push.force(0.0), drag.law.coefficient, run.time
    velocity = force / rate * (1.0 - np.exp(-rate * t))
    place = (force * t - velocity) / rate
    assert rate * t[-1] > 0.5
    np.testing.assert_allclose(run.velocity[:, 0, 0], velocity, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(run.displacement[:, 0, 0], place, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(run.exchange[:, -1], force * place, rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(run.exchange[:, 2], force * place - 0.5 * velocity**2, rtol=0.0, atol=1e-7)


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
@pytest.mark.parametrize("steps_a_call", [1, 3, 20], ids=lambda steps: f"{steps} steps a call")
def test_frames_are_the_same_bit_for_bit_however_many_steps_a_call_takes(steps_a_call, monkeypatch):
    """Seven steps a frame, while a force acts: parts of a frame in a call, or two frames."""
    one = pushed(Load(1, 1, half_sine(0.5, 3.0)), frames=40)
    whole = engine.run(one, steps_per_frame=7)
    monkeypatch.setattr(engine.IntegratorState, "steps_a_call", lambda *_: steps_a_call)
    parts = engine.run(one, steps_per_frame=7)
    for ours, theirs in ((parts.displacement, whole.displacement), (parts.velocity, whole.velocity)):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(parts.exchange, whole.exchange)


@pytest.mark.slow
def test_nothing_moves_that_the_push_has_not_reached():
    one = pushed(Load(1, 20, half_sine(0.8, 2.0)), chains=1, beads=40, frames=50)
    whole = engine.run(one)
    narrow = engine.run(one, rows=34)
    np.testing.assert_array_equal(whole.velocity, narrow.velocity)
    assert not whole.velocity[10, 0, 35:].any()
