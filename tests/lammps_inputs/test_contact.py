import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import contact

OVERLAPS = st.floats(1e-6, 1e3)
ENERGIES = st.floats(1e-9, 1e9)


@given(st.floats(max_value=0.0, allow_infinity=False))
def test_a_gap_has_neither_force_nor_energy_nor_stiffness(overlap):
    assert contact.force(overlap) == contact.energy(overlap) == contact.stiffness(overlap) == 0.0


@given(OVERLAPS)
def test_the_force_is_the_overlap_to_the_power_3_over_2(overlap):
    assert contact.force(overlap) == pytest.approx(overlap**1.5, rel=1e-15)


@given(OVERLAPS)
def test_the_energy_is_the_integral_of_the_force(overlap):
    nodes, weights = np.polynomial.legendre.leggauss(40)
    roots = 0.5 * math.sqrt(overlap) * (nodes + 1)  # overlap = root^2 makes the integrand a polynomial: exact
    integral = (weights * contact.force(roots**2) * 2 * roots).sum() * 0.5 * math.sqrt(overlap)
    assert contact.energy(overlap) == pytest.approx(integral, rel=1e-13)


@given(OVERLAPS)
def test_the_stiffness_is_the_slope_of_the_force(overlap):
    h = 1e-5 * overlap  # the central difference is off by f''' h^2 / 6 = 1e-10 / 24 of the slope, and 1e-16 / 1e-5
    slope = (contact.force(overlap + h) - contact.force(overlap - h)) / (2 * h)
    assert contact.stiffness(overlap) == pytest.approx(slope, rel=1e-10)


def test_arrays_of_any_shape_are_taken_element_by_element():
    assert contact.force(np.array([[-1.0, 0.0], [1.0, 4.0]])).tolist() == [[0.0, 0.0], [1.0, 8.0]]


@given(ENERGIES)
def test_the_largest_overlap_holds_the_whole_energy(energy):
    assert contact.energy(contact.largest_overlap(energy)) == pytest.approx(energy, rel=1e-14)


@given(ENERGIES)
def test_the_diameter_is_a_power_of_two_of_at_least_4(energy):
    diameter = contact.bead_diameter(energy)
    assert math.frexp(diameter)[0] == 0.5
    assert diameter >= 4.0


@given(ENERGIES)
def test_no_overlap_that_the_energy_allows_reaches_half_the_diameter(energy):
    assert contact.largest_overlap(energy) <= contact.bead_diameter(energy) / 2


@given(ENERGIES, st.floats(0.0, 1.0))
def test_no_share_of_the_energy_lets_second_neighbours_meet(energy, share):
    two = contact.largest_overlap(share * energy) + contact.largest_overlap((1 - share) * energy)
    assert two <= contact.bead_diameter(energy)


def test_one_kick_of_v_equal_1_has_beads_of_diameter_4():
    assert contact.bead_diameter(0.5) == 4.0


@given(ENERGIES)
def test_lammps_is_given_the_constant_that_makes_its_force_ours(energy):
    """LAMMPS: force = Kn sqrt(overlap) sqrt(R_eff) overlap with R_eff = diameter / 4."""
    diameter = contact.bead_diameter(energy)
    style, coefficients = contact.pair_lines(diameter)
    kn = float(style.split()[2])
    assert style.startswith("pair_style gran/hertz/history ")
    assert style.split()[3:] == ["0"] * 5
    assert coefficients == "pair_coeff * *"
    assert kn * math.sqrt(diameter / 4) == pytest.approx(1.0, rel=3e-16)
