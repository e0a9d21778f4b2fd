"""The energy budget names each part and each loss: by states made by hand."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import written_down

from analysis.conservation import STORED, Account, Budget, Conservation
from analysis.figures.energy import budget_figure
from analysis.quantity import plain
from lammps_inputs import library
from lammps_inputs.units import make_scale

NONE = dict.fromkeys(STORED, np.zeros(2))

PLAIN = {
    "name": "test",
    "chains": 2,
    "beads": 8,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 5.0,
    "damping": {"beads": 0.2, "coupling": 0.3},
}


LOST = np.array([0.0, 0.2, 0.3, 0.0, 0.7])
"""In contacts, springs, drag and walls until t = 1, and what was put in."""


def account_of(problem, motion, cuts=()):
    budget, whole = Budget(problem), written_down(problem, motion)
    whole = replace(whole, exchange=whole.time[:, np.newaxis] * LOST)
    for start, end in zip((0, *cuts), (*cuts, whole.frames), strict=True):
        budget.add(whole[start:end])
    return budget.result()


@pytest.mark.parametrize("cuts", [(), (1, 7, 30)])
def test_what_is_lost_is_told_by_the_name_of_what_takes_it(cuts):
    account = account_of(library.from_plain(PLAIN, "test").problem(), lambda t: (0.0 * t, 0.5 + 0.0 * t), cuts)
    assert sorted(account.lost) == ["bead_damping", "coupling_damping"]
    np.testing.assert_allclose(account.lost["coupling_damping"], 0.2 * account.time)
    np.testing.assert_allclose(account.lost["bead_damping"], 0.3 * account.time)
    np.testing.assert_allclose(account.energy_input, 0.5 + 0.7 * account.time)  # the kick has the energy 1/2
    np.testing.assert_allclose(account.stored["kinetic"], 16 * 0.5 * 0.5**2)


def test_springs_between_chains_and_to_the_ground_are_told_apart():
    """Every bead of chain 1 is ahead by 0.3."""
    problem = library.from_plain({**PLAIN, "foundation": {"stiffness": 0.5}}, "test").problem()
    ahead = np.array([[0.3], [0.0]])
    account = account_of(problem, lambda t: (ahead + 0.0 * t, 0.0 * t))
    held = {name: part[0] for name, part in account.stored.items()}
    energy = 8 * 0.5 * 0.3**2
    assert held == pytest.approx(
        {
            "kinetic": 0.0,
            "contacts": 0.0,
            "springs": 0.1 * energy,
            "ground": 0.5 * energy,
            "walls": 0.0,
            "resonators": 0.0,
        }
    )


def test_of_a_long_run_every_so_manieth_frame_counts_wherever_blocks_end():
    problem = library.from_plain({**PLAIN, "duration": 120.0}, "test").problem()
    account = account_of(problem, lambda t: (0.0 * t, 0.0 * t), (100, 101, 700))
    assert account.time.tolist() == (np.arange(0, 1201, 3) * problem.every).tolist()


@pytest.mark.parametrize("si", [False, True])
def test_the_sentence_is_in_the_scenes_units_and_names_the_largest_part_first(si):
    scale = make_scale(2.0, 3.0, 0.1, si=si)
    parts = NONE | {"kinetic": np.array([4.0, 1.0]), "springs": np.array([0.0, 0.5])}
    account = Account(np.array([0.0, 7.0]), np.array([4.0, 4.0]), **parts, lost={"bead_damping": np.array([0.0, 2.5])})
    joule, second = (" J", " s") if si else ("", "")
    assert account.sentence(scale) == (
        f"energy input {4.0 * scale.energy:.6g}{joule} until t = {7.0 * scale.time:.6g}{second}, of which "
        "62.50% lost in bead damping, 25.00% kinetic, 12.50% springs"
    )
    assert plain(account, scale)["time"] == [0.0, 7.0 * scale.time]
    assert plain(account, scale)["lost"] == {"bead_damping": [0.0, 2.5 * scale.energy]}
    assert account.missing.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(("left", "shares"), [(0.005, True), (0.003, False)])
def test_of_what_a_drive_took_back_no_shares_are_told(left, shares):
    """From a thousandth of the most on that it had put in."""
    parts, scale = NONE | {"kinetic": np.array([4.0, left])}, make_scale(2.0, 3.0, 0.1, si=True)
    said = Account(np.array([0.0, 7.0]), np.array([4.0, left]), **parts, lost={}).sentence(scale)
    assert said.endswith("of which 100.00% kinetic" if shares else f", at most {4.0 * scale.energy:.6g} J before")


def test_what_is_missing_is_told_in_the_scenes_units():
    scale = make_scale(2.0, 3.0, 0.1, si=True)
    account = Account(np.array([0.0, 7.0]), np.array([4.0, 4.0]), **NONE | {"kinetic": np.array([4.0, 1.0])}, lost={})
    assert plain(account, scale)["missing"] == pytest.approx([0.0, 3.0 * scale.energy])
    assert plain(account, scale)["energy_input"] == pytest.approx([4.0 * scale.energy] * 2)


def test_a_heavy_bead_is_kicked_with_its_own_energy():
    heavy = {"kinds": {"heavy": {"mass": 4.0}}, "replace": {"bead": 1, "kind": "heavy"}, "damping": {"beads": 0.2}}
    account = account_of(library.from_plain({**PLAIN, **heavy}, "test").problem(), lambda t: (0.0 * t, 0.0 * t))
    assert account.energy_input[0] == pytest.approx(2.0)


@pytest.mark.parametrize("cuts", [(), (1, 30)])
def test_the_drift_is_in_shares_of_the_most_that_was_put_in(cuts):
    problem, seen = library.from_plain(PLAIN, "test").problem(), Conservation()
    whole = written_down(problem, lambda t: (0.0 * t, 0.5 + 0.0 * t))
    whole = replace(whole, exchange=whole.time[:, np.newaxis] * LOST)
    for start, end in zip((0, *cuts), (*cuts, whole.frames), strict=True):
        seen.add(whole[start:end])
    missing = 2.0 + 0.5 * whole.time - (0.5 + 0.7 * whole.time)
    assert seen.energy_drift == pytest.approx(np.max(missing) / (0.5 + 0.7 * 5.0))


def test_the_last_frame_counts_though_it_is_none_of_these():
    problem = library.from_plain({**PLAIN, "duration": 120.1}, "test").problem()
    account = account_of(problem, lambda t: (0.0 * t, 0.0 * t), (100, 101, 1201))
    assert account.time.tolist() == (np.append(np.arange(0, 1201, 3), 1201) * problem.every).tolist()
    assert account.energy_input[-1] == pytest.approx(0.5 + 0.7 * problem.duration)
    assert "cut short" not in budget_figure(problem, account).get_suptitle()
