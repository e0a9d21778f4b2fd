"""Dashpots of walls: those of contacts, on either side, with a gap or under a static load."""

import numpy as np
import pytest

from lammps_inputs.laws import dashpot
from lammps_inputs.laws.dashpot import NO_FLOOR, ContactDashpot, Restitution, Viscoelastic, WallDashpot

PLACES = np.array([-0.6, -0.2, 0.3, 1.1])
LAWS = {
    "linear": (ContactDashpot(0.3), WallDashpot(0.3, 0.0, 0.0, NO_FLOOR, 1.0, 0.0)),
    "linear, cut": (ContactDashpot(0.3, 2.0), WallDashpot(0.3, 0.0, 0.0, 2.0, 1.0, 0.0)),
    "viscoelastic": (Viscoelastic(0.3), WallDashpot(0.0, 0.3, 0.0, NO_FLOOR, 1.0, 0.0)),
    "restitution": (Restitution(0.3, 0.7), WallDashpot(0.0, 0.0, 0.3, NO_FLOOR, 1.0, 0.0)),
}


@pytest.mark.parametrize("rest", [0.0, 0.4, -0.1], ids=["touching", "pressed", "gap"])
@pytest.mark.parametrize("name", LAWS)
def test_a_wall_resists_as_a_contact_of_that_overlap_does_on_either_side(name, rest):
    contact, wall = LAWS[name]
    right = wall._replace(rest=rest)
    for rate in (-20.0, -0.1, 2.0):
        expected = dashpot.damping(contact, PLACES + rest, rate)
        np.testing.assert_allclose(dashpot.damping(right, PLACES, rate), expected, rtol=1e-13)
        np.testing.assert_allclose(dashpot.damping(right.opposite(), -PLACES, -rate), -expected, rtol=1e-13)
    np.testing.assert_allclose(
        dashpot.resistance(right, PLACES), dashpot.resistance(contact, PLACES + rest), rtol=1e-13
    )
    np.testing.assert_allclose(right.growth(PLACES, *right), contact.growth(PLACES + rest, *contact), rtol=1e-13)


@pytest.mark.parametrize("rest", [0.0, 0.4, -0.1, np.full(4, 0.4)], ids=["touching", "pressed", "gap", "array"])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("name", LAWS)
def test_what_it_has_given_is_the_integral_of_its_resistance_and_nothing_at_rest(name, side, rest):
    law = LAWS[name][1]._replace(rest=rest, side=side)
    slope = (law.impulse(PLACES + 1e-6, *law) - law.impulse(PLACES - 1e-6, *law)) / 2e-6
    np.testing.assert_allclose(slope, dashpot.resistance(law, PLACES), rtol=1e-8, atol=1e-9)
    assert not np.any(law.impulse(0.0, *law))
    assert not np.any(dashpot.damping(law, 0.0, 0.0))


def test_beads_without_a_wall_feel_nothing_however_hard_they_are_pressed():
    law = WallDashpot(np.array([0.0, 0.3]), 0.0, 0.0, np.array([0.0, 2.0]), 1.0, 0.0)
    assert dashpot.damping(law, np.array([5.0, 5.0]), np.array([-9.0, -0.1])).tolist() == [0.0, -0.03]
