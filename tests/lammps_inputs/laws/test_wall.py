import numpy as np
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
