"""Scales of SI scenes, and a steel ball worked out by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import Material, units

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)
BALL = units.make_scale(
    units.sphere_mass(STEEL.radius, STEEL.density),
    units.hertz_constant(STEEL.radius, STEEL.youngs_modulus, STEEL.poisson_ratio),
    1.0,
    si=True,
)

SPEEDS = st.floats(-12.0, 12.0).map(lambda exponent: 10.0**exponent)


def half_a_digit(text):
    """Half a unit of the last digit of a number as it is printed."""
    mantissa, _, exponent = text.partition("e")
    return 0.5 * 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


@pytest.mark.parametrize(
    ("quantity", "value", "printed"),
    [
        ("mass", BALL.mass, "3.614e-3"),
        ("A", units.hertz_constant(4.76e-3, 193e9, 0.3), "6.898e9"),
        ("length", BALL.length, "12.2e-6"),
        ("time", BALL.time, "12.2e-6"),
        ("wave speed", 0.8405088 * 2 * STEEL.radius / BALL.time, "654"),
        ("peak force", (1.00866 * 0.6816315**0.8) ** 1.5 * BALL.force, "189"),
        ("k of kappa = 0.1", 0.1 * BALL.stiffness, "2.41e6"),
    ],
)
def test_the_steel_row_comes_out_to_its_last_digit(quantity, value, printed):
    assert abs(value - float(printed)) <= half_a_digit(printed), quantity


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e12), SPEEDS)
def test_in_its_own_units_every_chain_has_the_equation_of_motion_of_v_equal_1(mass, constant, velocity):
    scale = units.make_scale(mass, constant, velocity, si=True)
    assert constant * scale.length**1.5 == pytest.approx(scale.force, rel=1e-13)
    assert scale.mass * scale.length / scale.time**2 == pytest.approx(scale.force, rel=1e-13)
    assert scale.stiffness * scale.length == pytest.approx(scale.force, rel=1e-13)
    assert scale.force * scale.length == pytest.approx(scale.energy, rel=1e-13)
    assert scale.force * scale.time == pytest.approx(scale.momentum, rel=1e-13)


def test_hertz_constant_is_that_of_johnson_for_equal_spheres():
    """F = 4/3 E* sqrt(R*) overlap^1.5, with R* = R/2 and 1/E* = 2 (1 - nu^2)/E (Johnson 1985, eq. 4.22)."""
    radius, modulus, ratio = 0.01, 2e11, 0.25
    johnson = 4 / 3 * modulus / (2 * (1 - ratio**2)) * math.sqrt(radius / 2)
    assert units.hertz_constant(radius, modulus, ratio) == pytest.approx(johnson, rel=1e-14)


@pytest.mark.parametrize(
    ("unit", "largest", "shown"),
    [
        ("Hz", 9.3e4, ("kHz", 1e-3)),
        ("m/s", 3.0, ("m/s", 1.0)),
        ("m/s", 0.02, ("mm/s", 1e3)),
        ("m/s", 5e-6, ("\N{MICRO SIGN}m/s", 1e6)),
        ("m/s", 1e-30, ("pm/s", 1e12)),
        ("beads/s", 9e4, ("beads/s", 1.0)),
        ("reduced", 9e4, ("reduced", 1.0)),
        ("V", 1e-4, ("V", 1.0)),
        ("", 1e9, ("", 1.0)),
    ],
)
def test_labels_take_the_prefix_of_an_si_unit_that_makes_numbers_short(unit, largest, shown):
    label, worth = units.Label("x", "", unit).prefixed(largest)
    assert (label.unit, worth) == (shown[0], pytest.approx(shown[1]))
