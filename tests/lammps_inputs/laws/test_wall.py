import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import laws
from lammps_inputs.laws.wall import HertzWall, PowerWall

POSITIVE = st.floats(1e-6, 1e6)
SIDE = st.sampled_from([1.0, -1.0])
EXPONENT = st.sampled_from([1.0, 1.25, 1.5, 2.0, 3.0])


def wall(strength, side, gap, exponent=1.5):
    return HertzWall(strength, side, gap) if exponent == 1.5 else PowerWall(strength, exponent, side, gap)


@given(st.floats(-10.0, 10.0), st.floats(0.0, 5.0), SIDE, EXPONENT)
def test_a_wall_never_pulls_and_only_one_side_feels_it(place, gap, side, exponent):
    force = float(laws.force(wall(2.0, side, gap, exponent), place))
    assert force * side >= 0.0
    assert side * place > gap or force == 0.0
    assert side * place < gap + 1e-6 or force != 0.0


@given(POSITIVE, POSITIVE, SIDE, st.floats(0.0, 5.0), EXPONENT)
def test_the_largest_displacement_holds_the_whole_energy(energy, strength, side, gap, exponent):
    law = wall(np.array([0.0, strength]), side, gap, exponent)
    reach = law.reach(energy, *law)
    assert reach[0] == 0.0
    overlap = law.overlap(energy)[1]
    np.testing.assert_allclose(side * reach[1], gap + overlap, rtol=1e-15)
    rounding = 4e-16 * (1.0 + gap / overlap)
    np.testing.assert_allclose(laws.energy(law, reach)[1], energy, rtol=20.0 * rounding)
    assert np.max(law.overlap(energy)) == overlap


@given(st.floats(-10.0, 10.0), SIDE, EXPONENT)
def test_the_opposite_wall_is_the_mirror_image(place, side, exponent):
    law = wall(1.5, side, 0.25, exponent)
    assert laws.force(law.opposite(), -place) == -laws.force(law, place)
    assert laws.energy(law.opposite(), -place) == laws.energy(law, place)


@given(st.floats(0.2, 10.0), SIDE, EXPONENT)
def test_force_is_the_slope_of_energy_and_stiffness_that_of_force(overlap, side, exponent):
    law, h = wall(1.5, side, 0.1, exponent), 1e-5
    ahead, behind = (side * (0.1 + overlap + step) for step in (h, -h))
    place = side * (0.1 + overlap)
    slope = (laws.energy(law, ahead) - laws.energy(law, behind)) / (ahead - behind)
    np.testing.assert_allclose(slope, laws.force(law, place), rtol=1e-7)
    slope = (laws.force(law, ahead) - laws.force(law, behind)) / (ahead - behind)
    np.testing.assert_allclose(slope, laws.stiffness(law, place), rtol=1e-7)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_at_hertz_s_exponent_a_wall_of_any_is_hertz_s_to_rounding(side):
    place = np.linspace(-1.5, 1.5, 50)
    for of in (laws.force, laws.energy, laws.stiffness):
        assert of(PowerWall(1.3, 1.5, side, 0.2), place) == pytest.approx(
            of(HertzWall(1.3, side, 0.2), place), rel=1e-14
        )
