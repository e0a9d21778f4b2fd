import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_problems import system

from lammps_inputs import laws
from lammps_inputs.laws.contact import Hertz
from lammps_inputs.layout import Layout

HERTZ = Hertz()

OVERLAPS = st.floats(1e-6, 1e3)
ENERGIES = st.floats(1e-9, 1e9)


@given(st.floats(max_value=0.0, allow_infinity=False))
def test_a_gap_has_neither_force_nor_energy_nor_stiffness(overlap):
    assert laws.force(HERTZ, overlap) == laws.energy(HERTZ, overlap) == laws.stiffness(HERTZ, overlap) == 0.0


@given(OVERLAPS)
def test_the_force_is_the_overlap_to_the_power_3_over_2(overlap):
    assert laws.force(HERTZ, overlap) == pytest.approx(overlap**1.5, rel=1e-15)


def test_arrays_of_any_shape_are_taken_element_by_element():
    assert laws.force(HERTZ, np.array([[-1.0, 0.0], [1.0, 4.0]])).tolist() == [[0.0, 0.0], [1.0, 8.0]]


@given(ENERGIES)
def test_the_diameter_is_a_power_of_two_of_at_least_4(energy):
    diameter = Layout(system(energy)).diameter
    assert math.frexp(diameter)[0] == 0.5
    assert diameter >= 4.0


@given(ENERGIES)
def test_no_overlap_that_the_energy_allows_reaches_half_the_diameter(energy):
    assert laws.max_strain(HERTZ, energy) <= Layout(system(energy)).diameter / 2


@given(ENERGIES, st.floats(0.0, 1.0))
def test_no_share_of_the_energy_lets_second_neighbours_meet(energy, share):
    two = laws.max_strain(HERTZ, share * energy) + laws.max_strain(HERTZ, (1 - share) * energy)
    assert two <= Layout(system(energy)).diameter


def test_one_kick_of_v_equal_1_has_beads_of_diameter_4():
    assert Layout(system(0.5)).diameter == 4.0


@given(ENERGIES)
def test_lammps_is_given_the_constant_that_makes_its_force_ours(energy):
    """LAMMPS: force = Kn sqrt(overlap) sqrt(R_eff) overlap with R_eff = diameter / 4."""
    diameter = Layout(system(energy)).diameter
    _, style, coefficients = HERTZ.along("contacts", Layout(system(energy))).interactions
    kn = float(style.split()[2])
    assert style.startswith("pair_style gran/hertz/history ")
    assert style.split()[3:] == ["0"] * 5
    assert coefficients == "pair_coeff * *"
    assert kn * math.sqrt(diameter / 4) == pytest.approx(1.0, rel=3e-16)


@given(OVERLAPS, st.floats(0.0, 100.0))
def test_force_energy_and_stiffness_are_in_proportion_to_the_strength(overlap, strength):
    strong = Hertz(strength)
    for quantity in (laws.force, laws.energy, laws.stiffness):
        assert quantity(strong, overlap) == pytest.approx(strength * quantity(HERTZ, overlap), rel=1e-15)


def test_a_strength_of_its_own_for_each_contact_is_taken_place_by_place():
    law = Hertz(np.array([[1.0, 2.0], [3.0, 0.0]]))
    assert laws.force(law, np.ones((5, 2, 2)))[4].tolist() == [[1.0, 2.0], [3.0, 0.0]]
    assert laws.at(law, np.array([1, 0]), np.array([0, 1])).strength.tolist() == [3.0, 2.0]
