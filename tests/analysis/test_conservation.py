"""Energy and momentum of a run, compared with its kicks'; the energy budget, of states made by hand."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem, written_down
from stock_lammps import scene
from synthetic_waves import of_keys

from analysis.conservation import STORED, Account, AccountMeter, ConservationMeter
from analysis.figures.drawing import draw
from analysis.quantity import plain
from lammps_inputs import Kick
from lammps_inputs.laws.in_time import rectangular, sine
from lammps_inputs.loads import Load
from lammps_inputs.units import make_scale
from workflow.engines.reference.engine import run
from workflow.measures.budget import BudgetMeasurement

KICKS = (Kick(velocity=1.0), Kick(bead=8, velocity=-0.5))


@pytest.fixture(scope="module")
def found():
    """Two chains to t = 10, integrated so finely that energy is kept to 1e-8."""
    return run(scene(chains=2, beads=12, kappa=0.1, duration=10.0, kick=KICKS).problem(), steps_per_frame=32)


def seen(*blocks):
    return ConservationMeter(blocks[0].problem).read(blocks)


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
    push = Load(1, 1, rectangular(1.0, 2.0))

    def wrong(t):
        return np.where(t > 2.01, 1.0 + 2.0 + 0.3, 17.0)

    assert moved_by((push,), wrong) == pytest.approx(0.3 / (1.0 + 2.0))


def test_with_a_drive_momentum_is_that_of_now_or_as_lammps_has_it():
    """Half a step of the mean force around may be missing."""
    drive = Load(1, 1, sine(0.5, 2.0, 0.4))
    half = 0.005

    def halfway(t):
        return 0.5 * (drive.impulse(t - half) + drive.impulse(t + half))

    for right in (drive.impulse, halfway):
        assert moved_by((drive,), right, kicks=()) == pytest.approx(0.0, abs=1e-14)
        wrong = moved_by((drive,), lambda t, right=right: right(t) + 0.1 * (t > 5.0), kicks=())
        assert wrong == pytest.approx(0.1 / 0.5, rel=0.05)  # half a swing gives 0.5


# --- budget -----------------------------------------------------------------------------------------------------------

NONE = dict.fromkeys(STORED, np.zeros(2)) | {"other_atoms": None, "in_resonators_error": None}

PLAIN = {
    "chains": 2,
    "beads": 8,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 5.0,
    "damping": {"beads": 0.2, "coupling": 0.3},
}


LOST = np.array([0.0, 0.2, 0.3, 0.0, 0.7])
"""In contacts, springs, drag and walls until t = 1, and what was put in."""


def exchanging(problem, motion, cuts):
    """Blocks of a motion in which `LOST` is exchanged."""
    whole = written_down(problem, motion)
    whole = replace(whole, exchange=whole.time[:, np.newaxis] * LOST)
    return [whole[start:end] for start, end in zip((0, *cuts), (*cuts, whole.frames), strict=True)]


def account_of(problem, motion, cuts=()):
    return AccountMeter(problem).read(exchanging(problem, motion, cuts))


@pytest.mark.parametrize("cuts", [(), (1, 7, 30)])
def test_what_is_lost_is_told_by_the_name_of_what_takes_it(cuts):
    account = account_of(of_keys(**PLAIN), lambda t: (0.0 * t, 0.5 + 0.0 * t), cuts)
    assert sorted(account.dissipated) == ["bead_damping", "coupling_damping"]
    np.testing.assert_allclose(account.dissipated["coupling_damping"], 0.2 * account.time)
    np.testing.assert_allclose(account.dissipated["bead_damping"], 0.3 * account.time)
    np.testing.assert_allclose(account.energy_input, 0.5 + 0.7 * account.time)  # the kick has the energy 1/2
    np.testing.assert_allclose(account.stored["kinetic"], 16 * 0.5 * 0.5**2)


def test_springs_between_chains_and_to_the_ground_are_told_apart():
    """Every bead of chain 1 is ahead by 0.3."""
    problem = of_keys(**{**PLAIN, "foundation": {"stiffness": 0.5}})
    ahead = np.array([[0.3], [0.0]])
    account = account_of(problem, lambda t: (ahead + 0.0 * t, 0.0 * t))
    energy = 8 * 0.5 * 0.3**2
    expected = dict.fromkeys(STORED, 0.0) | {"springs": 0.1 * energy, "ground": 0.5 * energy}
    assert {name: part[0] for name, part in account.stored.items()} == pytest.approx(expected)


@pytest.mark.parametrize("duration", [120.0, 120.1])
def test_of_a_long_run_every_so_manieth_frame_and_the_last_count_wherever_blocks_end(duration):
    problem = of_keys(**{**PLAIN, "duration": duration})
    account = account_of(problem, lambda t: (0.0 * t, 0.0 * t), (100, 101, 1200))
    counted = sorted({*range(0, 1201, 3), problem.frames})
    assert account.time.tolist() == (np.array(counted) * problem.every).tolist()
    assert account.energy_input[-1] == pytest.approx(0.5 + 0.7 * duration)
    assert "cut short" not in draw(BudgetMeasurement(problem, account).sheet()).get_suptitle()


def test_the_axis_of_the_budget_holds_energy_that_a_drive_takes_up_first():
    problem = of_keys(**PLAIN)
    account = account_of(problem, lambda t: (0.0 * t, 0.0 * t))
    taken = replace(account, energy_input=account.energy_input - 1.0)
    ((panel,),) = BudgetMeasurement(problem, taken).sheet().rows
    low, high = panel.y.ends
    beyond = np.array([low, high]) / [np.min(panel.curves[0].y), np.max(panel.curves[0].y)]
    assert np.all((beyond > 1.0) & (beyond < 1.1))


@pytest.mark.parametrize("si", [False, True])
def test_the_sentence_is_in_the_scenes_units_and_names_the_largest_part_first(si):
    scale = make_scale(2.0, 3.0, 0.1, si=si)
    parts = NONE | {"kinetic": np.array([4.0, 1.0]), "springs": np.array([0.0, 0.5])}
    account = Account(
        np.array([0.0, 7.0]), np.array([4.0, 4.0]), **parts, dissipated={"bead_damping": np.array([0.0, 2.5])}
    )
    joule, second = (" J", " s") if si else ("", "")
    assert account.sentence(scale) == (
        f"the energy input until t = {7.0 * scale.time:.6g}{second} is {4.0 * scale.energy:.6g}{joule}: "
        "62.50% dissipated in bead damping, 25.00% kinetic, 12.50% in springs between chains"
    )
    assert plain(account, scale)["time"] == [0.0, 7.0 * scale.time]
    assert plain(account, scale)["dissipated"] == {"bead_damping": [0.0, 2.5 * scale.energy]}
    open_account = replace(account, dissipated={"bead_damping": np.array([0.0, 1.0])})
    assert plain(open_account, scale)["missing"] == pytest.approx([0.0, 1.5 * scale.energy])


def test_energy_before_any_input_is_an_infinite_drift():
    pushed = of_keys(**{**PLAIN, "kick": None, "push": {"peak": 1.0, "duration": 1.0, "shape": "half-sine"}})
    still = written_down(pushed, lambda t: (0.0 * t + np.arange(8.0)[::-1], 0.0 * t))[:1]
    assert seen(replace(still, exchange=np.zeros((1, 5)))).energy_drift == np.inf


@pytest.mark.parametrize("cuts", [(), (1, 30)])
def test_the_drift_is_in_shares_of_the_most_that_was_put_in(cuts):
    problem = of_keys(**PLAIN)
    drift = seen(*exchanging(problem, lambda t: (0.0 * t, 0.5 + 0.0 * t), cuts)).energy_drift
    time = np.arange(problem.frames + 1) * problem.every
    missing = 2.0 + 0.5 * time - (0.5 + 0.7 * time)
    assert drift == pytest.approx(np.max(missing) / (0.5 + 0.7 * 5.0))
