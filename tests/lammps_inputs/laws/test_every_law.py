"""The calculus of every law: a force is the slope of its energy, and what a dashpot has given the integral of it.

Under a static load rest is exactly rest, and no digit of a small motion is lost to the load.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from small_problems import system

from lammps_inputs import laws
from lammps_inputs.laws import dashpot
from lammps_inputs.laws.contact import Hertz, Power, pressed, under
from lammps_inputs.laws.dashpot import (
    NO_LIMIT,
    ContactDashpot,
    Dashpot,
    LinearRestitution,
    PowerRestitution,
    Restitution,
    Viscoelastic,
)
from lammps_inputs.laws.plastic import Thornton, WaltonBraun
from lammps_inputs.laws.spring import Duffing, Instant, Linear, Varying
from lammps_inputs.layout import layout_of
from lammps_inputs.links import Links

LOADED = np.array([0.0, 0.0, 0.4])
"""A wall holds the last bead of a chain only."""

LOADS, GRID = np.geomspace(1e-9, 1e6, 40), 2.0**-42

ELASTIC = {
    "spheres": Hertz(1.7),
    **{f"power {p}": Power(1.7, p) for p in (1.0, 1.25, 2.0, 3.0)},
    "spring": Linear(0.3),
    "cubic spring": Duffing(0.3, 0.7),
    "spring at an instant": Instant(0.3, 0.7),
}
PRESSED = {
    "spheres": under(Hertz(), 0.37, GRID),
    "spheres, arrays": under(Hertz(np.linspace(0.5, 2.0, 40)), LOADS, GRID),
    "linear": under(Power(1.0, 1.0), 0.37, GRID),
    "cubic, arrays": under(Power(np.linspace(0.5, 2.0, 40), 3.0), LOADS, GRID),
    "wall": under(Hertz(5.0 * LOADED), LOADED, GRID),
    "wall of power 2": under(Power(5.0 * LOADED, 2.0), LOADED, GRID),
}
LAWS = ELASTIC | {f"pressed {name}": law for name, law in PRESSED.items()}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("strain", [-2.0, -0.3, 0.003, 0.7, 3.0])
def test_force_is_the_slope_of_the_energy_and_stiffness_that_of_the_force(law, strain):
    h = 1e-5
    (low, high), (weak, strong) = ([of(law, s) for s in (strain - h, strain + h)] for of in (laws.energy, laws.force))
    size = 1.0 + np.max(np.abs(laws.force(law, 3.0))) + np.max(np.abs(laws.force(law, -3.0)))
    np.testing.assert_allclose((high - low) / (2 * h), laws.force(law, strain), rtol=1e-5, atol=1e-9 * size)
    np.testing.assert_allclose((strong - weak) / (2 * h), laws.stiffness(law, strain), rtol=1e-5, atol=1e-9 * size)


@settings(max_examples=15)
@given(energy=st.floats(1e-6, 1e6))
@pytest.mark.parametrize("law", [law for name, law in LAWS.items() if "wall" not in name])
def test_the_largest_strain_holds_the_whole_energy(law, energy):
    np.testing.assert_allclose(laws.energy(law, law.max_strain(energy, *law)), energy, rtol=1e-11)


@pytest.mark.parametrize("law", [law for name, law in ELASTIC.items() if "spring" not in name])
def test_contacts_push_only_where_beads_overlap_and_in_proportion_to_their_strength(law):
    strength = np.array([[1.0, 2.0], [3.0, 0.0]])
    strong = replace(law, strength=strength)
    for of in (laws.force, laws.energy, laws.stiffness):
        assert not np.any(of(law, np.array([-1e300, -0.1, 0.0]))[:2])
        np.testing.assert_allclose(of(strong, np.full((5, 2, 2), 0.7))[4], strength * of(law, 0.7) / 1.7, rtol=1e-15)
    assert laws.force(law, 0.0) == laws.energy(law, 0.0) == 0.0
    assert strong.max_strain(1.0, *strong)[1, 1] == 0.0
    assert laws.at(strong, np.array([1, 0]), np.array([0, 1])).strength.tolist() == [3.0, 2.0]


def test_spheres_push_with_the_overlap_to_the_power_3_over_2_and_so_does_that_power():
    s = np.geomspace(1e-6, 1e3, 50)
    np.testing.assert_allclose(laws.force(Hertz(), s), s**1.5, rtol=1e-15)
    for of in (laws.force, laws.energy, laws.stiffness):
        assert of(Power(1.3, 1.5), s) == pytest.approx(of(Hertz(1.3), s), rel=1e-14)


@pytest.mark.parametrize("depth", [0.0, 0.5], ids=["ramp", "modulated"])
@pytest.mark.parametrize("time", [0.4, 2.1, 3.7], ids=["before", "during", "after"])
def test_the_power_of_springs_that_vary_is_the_rate_of_their_energy_at_a_fixed_strain(depth, time):
    """A stiffness of 0.9 falls to 0.5 from t = 1 to 3; forces are the slopes of energies at all times."""
    law, strain, h = Varying(0.9, -0.2, 1.0, 3.0, depth, 1.3, 0.4), np.array([-0.7, 0.3, 2.0]), 1e-6
    before, after = (law.energy(strain, t, *law) for t in (time - h, time + h))
    np.testing.assert_allclose((after - before) / (2.0 * h), law.power(strain, time, *law), rtol=1e-8, atol=1e-9)
    stiffness = np.interp(time, [1.0, 3.0], [0.9, 0.5]) * (1.0 + depth * math.sin(1.3 * time + 0.4))
    np.testing.assert_allclose(law.energy(strain, time, *law), 0.5 * stiffness * strain**2, rtol=1e-14)
    np.testing.assert_allclose(law.force(strain, time, *law), stiffness * strain, rtol=1e-14)
    np.testing.assert_allclose(law.stiffness(strain, time, *law), np.full(3, stiffness), rtol=1e-14)
    now = law.now(time)
    np.testing.assert_allclose(now.force(strain, *now), stiffness * strain, rtol=1e-14)
    np.testing.assert_allclose(0.5 * strain * now.change(strain, *now), law.power(strain, time, *law), rtol=1e-14)


# --- under a static load ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", PRESSED.values(), ids=PRESSED)
def test_at_rest_there_is_no_force_and_no_energy_to_the_last_bit(law):
    assert not np.any(laws.force(law, 0.0))
    assert not np.any(laws.energy(law, 0.0))


@pytest.mark.parametrize("name", ["spheres, arrays", "linear", "cubic, arrays"])
def test_the_energy_of_small_strains_has_all_its_digits(name):
    law = PRESSED[name]
    expected = 0.5 * laws.stiffness(law, 0.0) * 1e-12**2
    np.testing.assert_allclose(laws.energy(law, 1e-12), expected, rtol=1e-5)


def test_the_energy_of_any_exponent_goes_on_smoothly_from_its_series():
    law, strain = under(Power(1.0, 2.5), 0.4, GRID), 0.1 * PRESSED["spheres"].rest * np.array([-1.0, 1.0])
    for s in strain:
        below, above = laws.energy(law, s * (1.0 - 1e-12)), laws.energy(law, s * (1.0 + 1e-12))
        assert above == pytest.approx(below, rel=1e-11)


def test_reach_of_a_pressed_wall_is_what_an_energy_adds_and_0_for_beads_without_one():
    law = PRESSED["wall"]
    added = law.max_strain(0.5, *law)
    assert law.rest[2] > 0.3
    assert added[:2].tolist() == [0.0, 0.0]
    assert laws.energy(law, added)[2] == pytest.approx(0.5, rel=1e-12)


def test_loads_are_those_asked_for_but_for_the_rounding_of_places():
    for law in (PRESSED["spheres, arrays"], PRESSED["cubic, arrays"]):
        np.testing.assert_allclose(law.load[1:], LOADS[1:], rtol=1e-6)
        assert np.array_equal(law.rest / GRID, np.round(law.rest / GRID))


def test_a_contact_that_bears_nothing_is_a_contact_without_load():
    for free, digits in ((Hertz(), 1e-14), (Power(1.0, 1.0), 1e-12), (Power(1.0, 3.0), 1e-12)):
        law = under(free, np.array([0.0, 0.1]), GRID)
        for s in (-0.3, 0.2):
            assert laws.force(law, s)[0] == pytest.approx(laws.force(free, s), rel=digits)
            assert laws.energy(law, s)[0] == pytest.approx(laws.energy(free, s), rel=digits)


@pytest.mark.parametrize("law", [PRESSED["spheres"], PRESSED["cubic, arrays"]], ids=["spheres", "cubic"])
def test_a_contact_pressed_so_many_times_bears_that_load(law):
    np.testing.assert_allclose(pressed(law, 2.0).load, 2.0 * law.load, rtol=1e-14)
    assert laws.force(pressed(law, 2.0), 0.0) == pytest.approx(0.0, abs=1e-9 * np.max(law.load))
    assert np.all(pressed(law, 0.0).load < 1e-100)


# --- contacts that yield ----------------------------------------------------------------------------------------------

YIELDING = {
    "yielded": Thornton(1.7, 0.1),
    "yielded under a load": Thornton(1.7, 0.1).pressed_to(0.2),
    "elastic under a load": Thornton(1.7, 0.1).pressed_to(0.03),
    "still elastic": Thornton(1.7, 0.6),
    "linear": WaltonBraun(1.7, 0.8),
}


@pytest.mark.parametrize("law", YIELDING.values(), ids=YIELDING)
def test_a_contact_that_yields_opens_at_its_permanent_overlap_and_has_lost_what_it_does_not_return(law):
    """Pressed to an overlap of 0.5 and let go; forces are integrated along both ways."""
    rest, load = (getattr(law, name, 0.0) for name in ("rest", "load"))
    largest = replace(law, largest=0.5)
    opens, top = float(largest.permanent(*largest)) - rest, 0.5 - rest

    def pushes(of, begin, end):
        return quad(lambda s: float(of.force(s, *of)) + load, begin, end, epsabs=1e-13, points=[0.1 - rest])[0]

    assert float(largest.force(opens - 1e-9, *largest)) + load == pytest.approx(0.0, abs=1e-15)
    assert float(largest.force(opens + 1e-3, *largest)) + load > 1e-5
    spent, returned = pushes(law, 0.0, top), pushes(largest, opens, top)
    lost = spent + pushes(law, float(law.permanent(*law)) - rest, 0.0) - returned
    assert float(largest.dissipated(*largest)) == pytest.approx(lost, rel=1e-8, abs=1e-10)
    assert float(law.max_strain(spent - load * top, *law)) == pytest.approx(top, rel=1e-8)
    assert float(law.next_state(top, *law)) == 0.5
    unloading = float(largest.stiffness(top - 1e-9, *largest))
    assert float(law.stiffest(spent - load * top, *law)) == pytest.approx(unloading, rel=1e-7)
    for of, s in ((law, 0.7 * top), (largest, 0.5 * (opens + top)), (largest, opens - 0.01)):
        slope = (of.force(s + 1e-6, *of) - of.force(s - 1e-6, *of)) / 2e-6
        assert float(of.stiffness(s, *of)) == pytest.approx(float(slope), rel=1e-7, abs=1e-9)
        gained = (of.energy(s + 1e-6, *of) - of.energy(s - 1e-6, *of)) / 2e-6
        assert of is law or float(of.force(s, *of)) == pytest.approx(float(gained), rel=1e-7, abs=1e-9)


def test_a_contact_that_yielded_under_its_load_goes_on_yielding_from_rest():
    law = YIELDING["yielded under a load"]
    assert law.largest == law.rest > law.onset
    assert float(law.stiffness(0.0, *law)) == pytest.approx(float(law.force(1e-7, *law)) / 1e-7, rel=1e-6)


# --- dashpots ---------------------------------------------------------------------------------------------------------

PLACES = np.array([-0.6, -0.2, 0.3, 1.1])
CONTACTS = {
    "linear": ContactDashpot(0.3),
    "linear, cut": ContactDashpot(0.3, 2.0),
    "viscoelastic": Viscoelastic(0.3),
    "viscoelastic, cut": Viscoelastic(0.3, 1.0),
    "restitution": Restitution(0.3, 0.7),
    "linear restitution": LinearRestitution(0.3, 0.7),
    "restitution, p = 2.5": PowerRestitution(0.3, 2.5, 0.7),
}


@pytest.mark.parametrize("free", CONTACTS.values(), ids=CONTACTS)
@pytest.mark.parametrize("rest", [0.0, 0.4, np.full(4, 0.4)], ids=["touching", "pressed", "array"])
def test_what_a_dashpot_has_given_is_the_integral_of_its_resistance_and_nothing_at_rest(free, rest):
    law = replace(free, rest=rest)
    slope = (law.impulse(PLACES + 1e-6, *law) - law.impulse(PLACES - 1e-6, *law)) / 2e-6
    np.testing.assert_allclose(slope, dashpot.resistance(law, PLACES), rtol=1e-8, atol=1e-9)
    assert not np.any(law.impulse(0.0, *law))
    assert not np.any(dashpot.damping(law, 0.0, 0.0))


@pytest.mark.parametrize("law", [*CONTACTS.values(), Dashpot(np.array([0.0, 0.3, 0.3, 0.3]))])
def test_the_growth_of_a_resistance_is_its_slope_in_the_strain(law):
    slope = (dashpot.resistance(law, PLACES + 1e-6) - dashpot.resistance(law, PLACES - 1e-6)) / 2e-6
    np.testing.assert_allclose(law.growth(PLACES, *law), slope, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("free", CONTACTS.values(), ids=CONTACTS)
def test_a_pressed_dashpot_is_that_of_the_whole_overlap(free):
    pressed = replace(free, rest=0.4)
    for rate in (-2.0, 0.1):
        np.testing.assert_allclose(
            dashpot.damping(pressed, PLACES, rate), dashpot.damping(free, PLACES + 0.4, rate), rtol=1e-14
        )
    found, right = (law.growth(s, *law) for law, s in ((pressed, PLACES), (free, PLACES + 0.4)))
    np.testing.assert_allclose(found, right, rtol=1e-14)


@pytest.mark.parametrize(("rest", "gap"), [(0.0, 0.0), (0.4, 0.0), (0.0, 0.1)], ids=["touching", "pressed", "gap"])
@pytest.mark.parametrize("name", CONTACTS)
def test_a_wall_resists_as_a_contact_of_that_overlap_does_on_either_side(name, rest, gap):
    law = CONTACTS[name]
    for rate in (-20.0, -0.1, 2.0):
        expected = dashpot.damping(law, PLACES + rest - gap, rate)
        for side, end in ((1.0, -1), (-1.0, 0)):
            felt, link = np.zeros((4, 3)), Links.wall("wall_damping", replace(law, rest=rest), side, gap)
            link.drive(felt, link.damping(side * np.tile(PLACES[:, np.newaxis], 3), np.full((4, 3), side * rate)))
            np.testing.assert_allclose(felt[:, end], -side * expected, rtol=1e-13)
            assert np.count_nonzero(felt) <= len(PLACES)


@pytest.mark.parametrize("law", [ContactDashpot(0.3, 2.0), Viscoelastic(0.3, 2.0)])
@pytest.mark.parametrize("rate", [-30.0, -0.01, 2.0])
def test_the_rate_of_change_of_a_dashpot_is_the_slope_of_its_force_in_time_also_where_tension_is_cut(law, rate):
    h = 1e-6
    later, before = (dashpot.damping(law, 0.4 + rate * t + 0.35 * t * t, rate + 0.7 * t) for t in (h, -h))
    found = dashpot.change(law, np.float64(0.4), np.float64(rate), np.float64(0.7))
    np.testing.assert_allclose(found, (later - before) / (2.0 * h), rtol=1e-7)


@pytest.mark.parametrize("law", [ContactDashpot(0.3, 2.0), Viscoelastic(0.3, 2.0)], ids=["linear", "viscoelastic"])
def test_a_cut_dashpot_pulls_as_hard_as_the_contact_pushes_and_no_harder(law):
    overlap = np.array([0.0, 0.2, 0.9])
    for rate in (-1e3, -10.0):
        np.testing.assert_allclose(dashpot.damping(law, overlap, rate), -2.0 * overlap**1.5)
    weak = dashpot.damping(law, overlap[1:], -1e-3)
    np.testing.assert_allclose(weak, dashpot.damping(replace(law, tensile_limit=NO_LIMIT), overlap[1:], -1e-3))


# --- in LAMMPS and at walls -------------------------------------------------------------------------------------------

ENERGIES = st.floats(1e-9, 1e9)


@pytest.mark.slow
@given(ENERGIES, st.floats(0.0, 1.0))
def test_beads_in_lammps_are_too_large_for_any_share_of_the_energy_to_let_second_neighbours_meet(energy, share):
    diameter = layout_of(system(energy)).diameter
    two = laws.max_strain(Hertz(), share * energy) + laws.max_strain(Hertz(), (1 - share) * energy)
    assert max(two, 2.0 * laws.max_strain(Hertz(), energy), 4.0) <= diameter
    assert math.frexp(diameter)[0] == 0.5  # a power of two


@given(st.floats(-10.0, 10.0), st.floats(0.0, 5.0), st.sampled_from([1.0, -1.0]), st.sampled_from([1.0, 1.5, 3.0]))
def test_a_wall_never_pulls_and_only_one_side_feels_it(place, gap, side, exponent):
    strength, force, x = np.array([[2.0]]), np.zeros((1, 1)), np.array([[place]])
    link = Links.wall("wall", Hertz(strength) if exponent == 1.5 else Power(strength, exponent), side, gap)
    link.drive(force, link.force(x))
    assert force * side <= 0.0
    assert side * place > gap or force == 0.0
    assert side * place < gap + 1e-6 or force != 0.0
    rate = link.force_rate(x, np.array([[1.0]]))
    np.testing.assert_allclose(side * rate, laws.stiffness(link.law, side * x - gap), rtol=1e-14)
