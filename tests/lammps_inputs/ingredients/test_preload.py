"""Precompression and gravity: sound, readings, time steps; the motion is in `test_every_ingredient`."""

import numpy as np
import pytest
from plain_scene import one_chain

from analysis.gauges.gauge import gauges
from analysis.sharing.impulses import measure
from lammps_inputs.limits import rates
from workflow.engines.reference import engine
from workflow.measures.forces.force_meter import ForceMeter
from workflow.prepare.settings import settle
from workflow.runs.run import run

pytestmark = pytest.mark.usefixtures("lammps_here")


def loaded(**changes):
    return one_chain(**{"output": {"every": 0.25}, **changes})


FREE = {"precompression": {"force": 0.3}}


@pytest.mark.slow
def test_a_pressed_chain_of_linear_contacts_swings_by_its_modes(tmp_path):
    """No contact opens, so that all is linear: modes 2 sin(q / 2) of a free chain, up to the cut-off 2 sqrt(k / m)."""
    beads, kick = 40, {"bead": 10, "velocity": 1.0}
    keys = {"contact": {"exponent": 1.0}, "precompression": {"force": 3.0}, "duration": 60.0, "timestep": 0.005}
    case = loaded(beads=beads, kick=kick, **keys)
    found = run(case, tmp_path / "run")
    q = np.pi * np.arange(beads) / beads
    shape = np.cos(np.outer(np.arange(beads) + 0.5, q)) * np.where(q > 0.0, np.sqrt(2.0), 1.0) / np.sqrt(beads)
    time = found.trajectory.time
    exact = np.cos(np.outer(time, 2.0 * np.sin(q / 2.0))) * shape[9] @ shape.T
    error = np.abs(found.trajectory.velocity[:, 0] - exact).max()
    assert error == pytest.approx(found.check.velocity, rel=0.01)
    assert error < 1e-4
    assert rates.sound_frequency(case.system) == pytest.approx(2.0, rel=1e-12)


@pytest.mark.slow
def test_small_and_large_loads_run_with_a_small_error_and_their_energy(tmp_path):
    for force in (1e-9, 1.0, 1e3):
        found = run(loaded(precompression={"force": force}, beads=20, duration=10.0), tmp_path / f"{force}")
        assert found.check.velocity < 3e-4, force
        assert found.check.reference.energy < 1e-6, force
        end = found.trajectory
        assert np.abs(end.velocity.sum(axis=(1, 2)) - 1.0).max() < 1e-9, force


def test_the_impulse_of_a_gauge_is_that_above_rest():
    problem = loaded(**FREE, beads=20, duration=8.0).problem()
    meter = ForceMeter(problem, gauges(problem.system, contacts=(15,)))
    trajectory = engine.run(problem)
    ahead = trajectory.velocity[-1, 0, 15:].sum()
    assert meter.read([trajectory]).impulse[0, 0] == pytest.approx(ahead, abs=1e-6)
    assert measure(problem, [trajectory]).imbalance < 1e-6


@pytest.mark.slow
def test_the_end_at_a_bead_comes_sooner_the_faster_sound_is():
    ends = [
        settle(loaded(precompression={"force": f}, beads=40, duration=None, until_bead=30))[0].duration
        for f in (0.1, 100.0)
    ]
    assert ends[0] > 2.0 * ends[1]
    assert ends[1] > 30 / rates.front_speed(loaded(precompression={"force": 100.0}).system)


@pytest.mark.parametrize("force", [0.37, 0.38, 0.41])
def test_between_unlike_walls_a_chain_rests_as_its_mirror_image_does(force):
    soft, hard = {"stiffness": 0.3}, {"stiffness": 2.0}
    one, other = (
        loaded(beads=9, precompression={"force": force}, walls={"left": left, "right": right}).system.along[0].law
        for left, right in ((soft, hard), (hard, soft))
    )
    assert one.rest == other.rest
