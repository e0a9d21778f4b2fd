import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lammps_inputs import laws
from lammps_inputs.laws.wall import HertzWall

POSITIVE = st.floats(1e-6, 1e6)
SIDE = st.sampled_from([1.0, -1.0])


@given(st.floats(-10.0, 10.0), st.floats(0.0, 5.0), SIDE)
def test_a_wall_never_pulls_and_only_one_side_feels_it(place, gap, side):
    force = float(laws.force(HertzWall(2.0, side, gap), place))
    assert force * side >= 0.0
    assert side * place > gap or force == 0.0
    assert side * place < gap + 1e-6 or force != 0.0


@given(POSITIVE, POSITIVE, SIDE, st.floats(0.0, 5.0))
def test_the_largest_displacement_holds_the_whole_energy(energy, strength, side, gap):
    law = HertzWall(np.array([0.0, strength]), side, gap)
    reach = law.reach(energy, *law)
    assert reach[0] == 0.0
    overlap = law.overlap(energy)[1]
    np.testing.assert_allclose(side * reach[1], gap + overlap, rtol=1e-15)
    rounding = 4e-16 * (1.0 + gap / overlap)
    np.testing.assert_allclose(laws.energy(law, reach)[1], energy, rtol=20.0 * rounding)


@given(st.floats(-10.0, 10.0), SIDE)
def test_the_opposite_wall_is_the_mirror_image(place, side):
    law = HertzWall(1.5, side, 0.25)
    assert laws.force(law.opposite(), -place) == -laws.force(law, place)
    assert laws.energy(law.opposite(), -place) == laws.energy(law, place)


@given(st.floats(0.2, 10.0), SIDE)
def test_force_is_the_slope_of_energy_and_stiffness_that_of_force(overlap, side):
    law, h = HertzWall(1.5, side, 0.1), 1e-5
    ahead, behind = (side * (0.1 + overlap + step) for step in (h, -h))
    place = side * (0.1 + overlap)
    slope = (laws.energy(law, ahead) - laws.energy(law, behind)) / (ahead - behind)
    np.testing.assert_allclose(slope, laws.force(law, place), rtol=1e-7)
    slope = (laws.force(law, ahead) - laws.force(law, behind)) / (ahead - behind)
    np.testing.assert_allclose(slope, laws.stiffness(law, place), rtol=1e-7)
