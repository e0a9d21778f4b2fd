"""Contacts under a static load: rest is exactly rest, and no digit of a small motion is lost to the load."""

import numpy as np
import pytest

from lammps_inputs import laws
from lammps_inputs.laws.contact import Hertz, Power
from lammps_inputs.laws.preloaded import pressed, under

LOADS = np.geomspace(1e-9, 1e6, 40)
LAWS = {
    "numbers": under(Hertz(), 0.37, 2.0**-42),
    "arrays": under(Hertz(np.linspace(0.5, 2.0, 40)), LOADS, 2.0**-42),
    "linear": under(Power(1.0, 1.0), 0.37, 2.0**-42),
    "cubic, arrays": under(Power(np.linspace(0.5, 2.0, 40), 3.0), LOADS, 2.0**-42),
    "wall": under(Hertz(np.array([0.0, 0.0, 2.0])), np.array([0.0, 0.0, 0.4]), 2.0**-42),
    "square wall": under(Power(np.array([0.0, 0.0, 2.0]), 2.0), np.array([0.0, 0.0, 0.4]), 2.0**-42),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_at_rest_there_is_no_force_and_no_energy_to_the_last_bit(law):
    assert not np.any(laws.force(law, 0.0))
    assert not np.any(laws.energy(law, 0.0))


@pytest.mark.parametrize("name", ["arrays", "linear", "cubic, arrays"])
def test_the_energy_of_small_strains_has_all_its_digits(name):
    law = LAWS[name]
    expected = 0.5 * laws.stiffness(law, 0.0) * 1e-12**2
    np.testing.assert_allclose(laws.energy(law, 1e-12), expected, rtol=1e-5)


def test_the_energy_of_any_exponent_goes_on_smoothly_from_its_series():
    law, strain = under(Power(1.0, 2.5), 0.4, 2.0**-42), 0.1 * LAWS["numbers"].rest * np.array([-1.0, 1.0])
    for s in strain:
        below, above = laws.energy(law, s * (1.0 - 1e-12)), laws.energy(law, s * (1.0 + 1e-12))
        assert above == pytest.approx(below, rel=1e-11)


def test_reach_of_a_pressed_wall_is_what_an_energy_adds_and_0_for_beads_without_one():
    law = LAWS["wall"]
    added = law.max_strain(0.5, *law)
    assert law.rest[2] > 0.3
    assert added[:2].tolist() == [0.0, 0.0]
    assert laws.energy(law, added)[2] == pytest.approx(0.5, rel=1e-12)


def test_loads_are_those_asked_for_but_for_the_rounding_of_places():
    for law in (LAWS["arrays"], LAWS["cubic, arrays"]):
        np.testing.assert_allclose(law.load[1:], LOADS[1:], rtol=1e-6)
        assert np.array_equal(law.rest / 2.0**-42, np.round(law.rest / 2.0**-42))


def test_a_contact_that_bears_nothing_is_a_contact_without_load():
    for free, digits in ((Hertz(), 1e-14), (Power(1.0, 1.0), 1e-12), (Power(1.0, 3.0), 1e-12)):
        law = under(free, np.array([0.0, 0.1]), 2.0**-42)
        for s in (-0.3, 0.2):
            assert laws.force(law, s)[0] == pytest.approx(laws.force(free, s), rel=digits)
            assert laws.energy(law, s)[0] == pytest.approx(laws.energy(free, s), rel=digits)


@pytest.mark.parametrize("law", [LAWS["numbers"], LAWS["cubic, arrays"]], ids=["spheres", "cubic"])
def test_a_contact_pressed_so_many_times_bears_that_load(law):
    np.testing.assert_allclose(pressed(law, 2.0).load, 2.0 * law.load, rtol=1e-14)
    assert laws.force(pressed(law, 2.0), 0.0) == pytest.approx(0.0, abs=1e-9 * np.max(law.load))
    assert np.all(pressed(law, 0.0).load < 1e-100)
