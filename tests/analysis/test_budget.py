"""The energy budget names each part and each loss: by states made by hand."""

import numpy as np
import pytest
from small_problems import written_down

from analysis.budget import Account, Budget
from lammps_inputs import library
from lammps_inputs.units import make_scale

PLAIN = {
    "name": "test",
    "chains": 2,
    "beads": 8,
    "coupling": {"stiffness": 0.1},
    "kick": {"velocity": 1.0},
    "duration": 5.0,
    "damping": {"beads": 0.2, "coupling": 0.3},
}


def account_of(problem, motion, cuts=()):
    budget, whole = Budget(problem), written_down(problem, motion)
    for start, end in zip((0, *cuts), (*cuts, whole.frames), strict=True):
        budget.add(whole[start:end])
    return budget.result()


@pytest.mark.parametrize("cuts", [(), (1, 7, 30)])
def test_what_drag_takes_is_lost_in_drag(cuts):
    """All beads slow down together, so that no spring and no contact feels anything."""
    problem = library.from_plain(PLAIN, "test").problem()
    account = account_of(problem, lambda t: ((1.0 - np.exp(-0.2 * t)) / 0.2, np.exp(-0.2 * t)), cuts)
    lost = 8.0 * (1.0 - np.exp(-0.4 * account.time))
    np.testing.assert_allclose(account.lost["bead_damping"], lost, atol=1e-10)
    np.testing.assert_allclose(account.lost["coupling_damping"], 0.0, atol=1e-12)
    np.testing.assert_allclose(account.held["kinetic"], 8.0 - lost, atol=1e-12)


def test_springs_between_chains_and_to_the_ground_are_told_apart():
    """Every bead of chain 1 is ahead by 0.3."""
    problem = library.from_plain({**PLAIN, "foundation": {"stiffness": 0.5}}, "test").problem()
    ahead = np.array([[0.3], [0.0]])
    account = account_of(problem, lambda t: (ahead + 0.0 * t, 0.0 * t))
    held = {name: part[0] for name, part in account.held.items()}
    energy = 8 * 0.5 * 0.3**2
    assert held == pytest.approx({"kinetic": 0.0, "contacts": 0.0, "springs": 0.1 * energy, "ground": 0.5 * energy})


def test_of_a_long_run_every_so_manieth_frame_counts_wherever_blocks_end():
    problem = library.from_plain({**PLAIN, "duration": 120.0}, "test").problem()
    account = account_of(problem, lambda t: (0.0 * t, 0.0 * t), (100, 101, 700))
    assert account.time.tolist() == (np.arange(0, 1201, 3) * problem.every).tolist()


@pytest.mark.parametrize("si", [False, True])
def test_the_sentence_is_in_the_scenes_units_and_names_the_largest_part_first(si):
    scale = make_scale(2.0, 3.0, 0.1, si=si)
    parts = {"kinetic": np.array([4.0, 1.0]), "contacts": np.array([0.0, 0.0]), "springs": np.array([0.0, 0.5])}
    account = Account(np.array([0.0, 7.0]), np.array([4.0, 4.0]), parts, {"bead_damping": np.array([0.0, 2.5])})
    joule = " J" if si else ""
    assert account.sentence(scale) == (
        f"energy: {4.0 * scale.energy:.6g}{joule} put in until t = {7.0 * scale.time:.6g}, of which "
        "62.50% lost in bead damping, 25.00% kinetic, 12.50% springs"
    )
    assert account.plain(scale)["time"] == [0.0, 7.0 * scale.time]
    assert account.plain(scale)["lost"] == {"bead_damping": [0.0, 2.5 * scale.energy]}
    assert account.missing.tolist() == [0.0, 0.0]
