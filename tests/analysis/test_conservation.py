"""Energy and momentum of a run, compared with its kicks'."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem, written_down
from stock_lammps import scene

from analysis.conservation import Conservation
from lammps_inputs import Kick, physics
from lammps_inputs.laws.in_time import Rectangular, Sine
from lammps_inputs.loads import Load
from workflow.engines.reference.engine import run

KICKS = (Kick(velocity=1.0), Kick(bead=8, velocity=-0.5))


@pytest.fixture(scope="module")
def found():
    """Two chains to t = 10, integrated so finely that energy is kept to 1e-8."""
    return run(scene(chains=2, beads=12, kappa=0.1, duration=10.0, kick=KICKS).problem(), steps_per_frame=32)


def seen(*blocks):
    conservation = Conservation()
    for block in blocks:
        conservation.add(block)
    return conservation


def test_an_exact_run_keeps_both(found):
    drift = seen(found)
    assert drift.energy_drift < 1e-8
    assert drift.momentum_drift < 1e-13


def test_energy_drift_is_relative_to_the_energy_of_the_kicks(found):
    wrong = found.velocity.copy()
    wrong[40] *= np.sqrt(1.21)
    kinetic = 0.5 * (found.velocity[40] ** 2).sum()
    drift = seen(replace(found, velocity=wrong)).energy_drift
    assert drift == pytest.approx(0.21 * kinetic / (0.5 * (1 + 0.25)), abs=1e-8)


def test_momentum_drift_is_relative_to_the_sum_of_the_kicks_sizes(found):
    wrong = found.velocity.copy()
    wrong[40, 1, 5] -= 0.3
    assert seen(replace(found, velocity=wrong)).momentum_drift == pytest.approx(0.3 / 1.5, abs=1e-13)


def test_kicks_that_cancel_have_a_momentum_to_keep():
    two = scene(beads=4, kick=(Kick(velocity=1.0), Kick(bead=4, velocity=-1.0)), duration=3.0).problem()
    assert physics.momentum(two.system) == 0.0
    assert seen(run(two)).momentum_drift < 1e-14


@pytest.mark.parametrize("cut", [1, 50, 100])
def test_blocks_add_up_to_the_whole(cut, found):
    whole, parts = seen(found), seen(found[:cut], found[cut:])
    assert vars(whole) == vars(parts)


def test_the_worst_frame_of_any_block_counts(found):
    wrong = found.velocity.copy()
    wrong[10] *= 1.1
    spoiled = replace(found, velocity=wrong)
    assert seen(spoiled[:30], spoiled[30:]).energy_drift == seen(spoiled).energy_drift > 0.01


def test_frames_time_and_front_are_those_seen(found):
    drift = seen(found[:31])
    assert drift.frames == 31
    assert drift.last_time == found.time[30]
    moving = (np.abs(found.velocity[:31]) > 1e-3).any(axis=(0, 1))
    assert drift.front == np.flatnonzero(moving)[-1] + 1


def test_drifts_are_unknown_where_not_all_beads_are_recorded():
    part = run(scene(chains=2, beads=12, kappa=0.1, duration=10.0, recorded=(2, 7)).problem())
    drift = seen(part)
    assert np.isnan(drift.energy_drift)
    assert np.isnan(drift.momentum_drift)
    assert drift.front == 7


def test_the_front_is_the_foremost_bead_that_ever_moved_at_a_thousandth_of_the_kick(found):
    velocity = np.zeros_like(found.velocity)
    velocity[5, 0, 9] = 0.9e-3
    assert seen(replace(found, velocity=velocity)).front is None
    velocity[3, 1, 6] = -1.1e-3
    assert seen(replace(found, velocity=velocity)).front == 7


def moved_by(loads, momentum, **changes):
    """The drift where bead 1 of chain 1 has a momentum over time and all else rests."""
    acted = problem(loads=loads, **changes)
    here = np.zeros((2, 8))
    here[0, 0] = 1.0
    return seen(written_down(acted, lambda t: (0.0 * t, momentum(t) * here))).momentum_drift


def test_with_a_push_momentum_is_asked_for_afterwards_in_shares_of_all_blows():
    push = Load(1, 1, Rectangular(1.0, 2.0))

    def wrong(t):
        return np.where(t > 2.01, 1.0 + 2.0 + 0.3, 17.0)

    assert moved_by((push,), wrong) == pytest.approx(0.3 / (1.0 + 2.0))


def test_with_a_drive_momentum_is_that_of_now_or_as_lammps_has_it():
    """Half a step of the mean force around may be missing."""
    drive = Load(1, 1, Sine(0.5, 2.0, 0.4))
    half = 0.005

    def halfway(t):
        return 0.5 * (drive.impulse(t - half) + drive.impulse(t + half))

    for right in (drive.impulse, halfway):
        assert moved_by((drive,), right, kicks=()) == pytest.approx(0.0, abs=1e-14)
        wrong = moved_by((drive,), lambda t, right=right: right(t) + 0.1 * (t > 5.0), kicks=())
        assert wrong == pytest.approx(0.1 / 0.5, rel=0.05)  # half a swing gives 0.5
