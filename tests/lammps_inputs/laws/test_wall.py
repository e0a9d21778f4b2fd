import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs.laws.contact import Hertz, Power
from lammps_inputs.links import Wall

POSITIVE = st.floats(1e-6, 1e6)
SIDE = st.sampled_from([1.0, -1.0])
EXPONENT = st.sampled_from([1.0, 1.25, 1.5, 2.0, 3.0])


def wall(strength, side, gap, exponent=1.5):
    strength = np.array([[strength]])
    return Wall("wall", Hertz(strength) if exponent == 1.5 else Power(strength, exponent), side, gap)


def pushed(link, place):
    """Force on the bead at a place."""
    total, x = np.zeros((1, 1)), np.array([[place]])
    link.drive(total, link.force(x))
    return float(total[0, 0])


def energy(link, place):
    return float(link.energy(np.array([[place]]))[0, 0])


@given(st.floats(-10.0, 10.0), st.floats(0.0, 5.0), SIDE, EXPONENT)
def test_a_wall_never_pulls_and_only_one_side_feels_it(place, gap, side, exponent):
    force = pushed(wall(2.0, side, gap, exponent), place)
    assert force * side <= 0.0
    assert side * place > gap or force == 0.0
    assert side * place < gap + 1e-6 or force != 0.0


@given(POSITIVE, POSITIVE, SIDE, st.floats(0.0, 5.0), EXPONENT)
def test_the_largest_overlap_holds_the_whole_energy(held, strength, side, gap, exponent):
    link = wall(strength, side, gap, exponent)
    overlap = float(link.law.max_strain(held, *link.law)[0, 0])
    rounding = 4e-16 * (1.0 + gap / overlap)
    np.testing.assert_allclose(energy(link, side * (gap + overlap)), held, rtol=20.0 * rounding)
    assert type(link.law)(0.0, *link.law[1:]).max_strain(held, 0.0, *link.law[1:]) == 0.0


@given(st.floats(-10.0, 10.0), SIDE, EXPONENT)
def test_the_wall_of_the_mirrored_chain_is_the_mirror_image(place, side, exponent):
    link = wall(1.5, side, 0.25, exponent)
    assert pushed(link.mirrored(), -place) == -pushed(link, place)
    assert energy(link.mirrored(), -place) == energy(link, place)


@given(st.floats(0.2, 10.0), SIDE, EXPONENT)
def test_force_is_the_slope_of_energy_and_its_rate_that_of_force(overlap, side, exponent):
    link, h = wall(1.5, side, 0.1, exponent), 1e-5
    ahead, behind = (side * (0.1 + overlap + step) for step in (h, -h))
    place = side * (0.1 + overlap)
    slope = (energy(link, ahead) - energy(link, behind)) / (ahead - behind)
    np.testing.assert_allclose(slope, -pushed(link, place), rtol=1e-7)
    slope = -(pushed(link, ahead) - pushed(link, behind)) / (ahead - behind)
    rate = side * link.force_rate(np.array([[place]]), np.array([[1.0]]))[0, 0]
    np.testing.assert_allclose(slope, rate, rtol=1e-7)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_at_hertz_s_exponent_a_contact_of_any_is_hertz_s_to_rounding(side):
    hertz, any_power = (Wall("wall", law, side, 0.2) for law in (Hertz(1.3), Power(1.3, 1.5)))
    for place in np.linspace(-1.5, 1.5, 50):
        assert pushed(any_power, place) == pytest.approx(pushed(hertz, place), rel=1e-14)
        assert energy(any_power, place) == pytest.approx(energy(hertz, place), rel=1e-14)
