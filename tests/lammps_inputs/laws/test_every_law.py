"""The calculus of every law: a force is the slope of its energy, and what a dashpot has given the integral of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import laws
from lammps_inputs.laws import dashpot
from lammps_inputs.laws.contact import Hertz, Power
from lammps_inputs.laws.dashpot import NO_LIMIT, ContactDashpot, Restitution, Viscoelastic, WallDashpot
from lammps_inputs.laws.preloaded import under
from lammps_inputs.laws.spring import Duffing, Linear
from lammps_inputs.links import Wall

LOADED = np.array([0.0, 0.0, 0.4])
"""A wall holds the last bead of a chain only."""

ELASTIC = {
    "spheres": Hertz(1.7),
    **{f"power {p}": Power(1.7, p) for p in (1.0, 1.25, 2.0, 3.0)},
    "spring": Linear(0.3),
    "cubic spring": Duffing(0.3, 0.7),
    "pressed": under(Hertz(), 0.37, 2.0**-42),
    "pressed, arrays": under(Hertz(np.linspace(0.5, 2.0, 40)), np.geomspace(1e-9, 1e6, 40), 2.0**-42),
    "pressed, linear": under(Power(1.0, 1.0), 0.37, 2.0**-42),
    "pressed, cubic": under(Power(np.linspace(0.5, 2.0, 40), 3.0), np.geomspace(1e-9, 1e6, 40), 2.0**-42),
    "pressed wall": under(Hertz(5.0 * LOADED), LOADED, 2.0**-42),
    "pressed wall of power 2": under(Power(5.0 * LOADED, 2.0), LOADED, 2.0**-42),
}


@pytest.mark.parametrize("law", ELASTIC.values(), ids=ELASTIC)
@pytest.mark.parametrize("strain", [-2.0, -0.3, 0.003, 0.7, 3.0])
def test_force_is_the_slope_of_the_energy_and_stiffness_that_of_the_force(law, strain):
    h = 1e-5
    (low, high), (weak, strong) = ([of(law, s) for s in (strain - h, strain + h)] for of in (laws.energy, laws.force))
    size = 1.0 + np.max(np.abs(laws.force(law, 3.0))) + np.max(np.abs(laws.force(law, -3.0)))
    np.testing.assert_allclose((high - low) / (2 * h), laws.force(law, strain), rtol=1e-5, atol=1e-9 * size)
    np.testing.assert_allclose((strong - weak) / (2 * h), laws.stiffness(law, strain), rtol=1e-5, atol=1e-9 * size)


@pytest.mark.parametrize("law", [law for name, law in ELASTIC.items() if "pressed wall" not in name])
@given(energy=st.floats(1e-6, 1e6))
def test_the_largest_strain_holds_the_whole_energy(law, energy):
    np.testing.assert_allclose(laws.energy(law, law.max_strain(energy, *law)), energy, rtol=1e-11)


def test_at_hertz_s_exponent_a_law_of_any_exponent_is_hertz_s_to_rounding():
    s = np.linspace(-1.5, 1.5, 50)
    for of in (laws.force, laws.energy, laws.stiffness):
        assert of(Power(1.3, 1.5), s) == pytest.approx(of(Hertz(1.3), s), rel=1e-14)


PLACES = np.array([-0.6, -0.2, 0.3, 1.1])
WALLS = {
    "linear": WallDashpot(0.3, 0.0, 0.0, NO_LIMIT),
    "linear, cut": WallDashpot(0.3, 0.0, 0.0, 2.0),
    "viscoelastic": WallDashpot(0.0, 0.3, 0.0, NO_LIMIT),
    "restitution": WallDashpot(0.0, 0.0, 0.3, NO_LIMIT),
}
CONTACTS = {
    "linear": ContactDashpot(0.3),
    "linear, cut": ContactDashpot(0.3, 2.0),
    "viscoelastic": Viscoelastic(0.3),
    "viscoelastic, cut": Viscoelastic(0.3, 1.0),
    "restitution": Restitution(0.3, 0.7),
}
DASHPOTS = [*CONTACTS.values(), *WALLS.values()]


@pytest.mark.parametrize("free", DASHPOTS)
@pytest.mark.parametrize("rest", [0.0, 0.4, np.full(4, 0.4)], ids=["touching", "pressed", "array"])
def test_what_a_dashpot_has_given_is_the_integral_of_its_resistance_and_nothing_at_rest(free, rest):
    law = free._replace(rest=rest)
    slope = (law.impulse(PLACES + 1e-6, *law) - law.impulse(PLACES - 1e-6, *law)) / 2e-6
    np.testing.assert_allclose(slope, dashpot.resistance(law, PLACES), rtol=1e-8, atol=1e-9)
    assert not np.any(law.impulse(0.0, *law))
    assert not np.any(dashpot.damping(law, 0.0, 0.0))


@pytest.mark.parametrize("free", CONTACTS.values(), ids=CONTACTS)
def test_a_pressed_dashpot_is_that_of_the_whole_overlap(free):
    pressed = free._replace(rest=0.4)
    for rate in (-2.0, 0.1):
        np.testing.assert_allclose(
            dashpot.damping(pressed, PLACES, rate), dashpot.damping(free, PLACES + 0.4, rate), rtol=1e-14
        )
    for name in ("resistance", "growth"):
        found, right = (getattr(law, name)(s, *law) for law, s in ((pressed, PLACES), (free, PLACES + 0.4)))
        np.testing.assert_allclose(found, right, rtol=1e-14)


@pytest.mark.parametrize(("rest", "gap"), [(0.0, 0.0), (0.4, 0.0), (0.0, 0.1)], ids=["touching", "pressed", "gap"])
@pytest.mark.parametrize("name", WALLS)
def test_a_wall_resists_as_a_contact_of_that_overlap_does_on_either_side(name, rest, gap):
    contact, right = CONTACTS[name], WALLS[name]._replace(rest=rest)
    for rate in (-20.0, -0.1, 2.0):
        expected = dashpot.damping(contact, PLACES + rest - gap, rate)
        for side in (1.0, -1.0):
            felt, link = np.zeros((1, 4)), Wall("wall_damping", right, side, gap)
            link.drive(felt, link.damping(side * PLACES[np.newaxis], np.full((1, 4), side * rate)))
            np.testing.assert_allclose(felt[0], -side * expected, rtol=1e-13)
    for of in ("resistance", "growth"):
        found, expected = getattr(right, of)(PLACES, *right), getattr(contact, of)(PLACES + rest, *contact)
        np.testing.assert_allclose(found, expected, rtol=1e-13)


@pytest.mark.parametrize("law", [ContactDashpot(0.3, 2.0), Viscoelastic(0.3, 2.0)], ids=["linear", "viscoelastic"])
def test_a_cut_dashpot_pulls_as_hard_as_the_contact_pushes_and_no_harder(law):
    overlap = np.array([0.0, 0.2, 0.9])
    for rate in (-1e3, -10.0):
        np.testing.assert_allclose(dashpot.damping(law, overlap, rate), -2.0 * overlap**1.5)
    weak = dashpot.damping(law, overlap[1:], -1e-3)
    np.testing.assert_allclose(weak, dashpot.damping(law._replace(tensile_limit=NO_LIMIT), overlap[1:], -1e-3))


def test_beads_without_a_wall_feel_nothing_however_hard_they_are_pressed():
    law = WallDashpot(np.array([0.0, 0.3]), 0.0, 0.0, np.array([0.0, 2.0]))
    assert dashpot.damping(law, np.array([5.0, 5.0]), np.array([-9.0, -0.1])).tolist() == [0.0, -0.03]
