"""Dashpots of contacts: what they have given in time is the integral of what they resist, also under a static load."""

import numpy as np
import pytest

from lammps_inputs.laws import dashpot
from lammps_inputs.laws.dashpot import ContactDashpot, Restitution, Viscoelastic

REST = 0.4
LAWS = {
    "linear": ContactDashpot(0.3),
    "linear, cut": ContactDashpot(0.3, 1.0),
    "viscoelastic": Viscoelastic(0.3),
    "viscoelastic, cut": Viscoelastic(0.3, 1.0),
    "restitution": Restitution(0.3, 0.7),
}
STRAINS = np.array([-0.6, -0.2, 0.3, 1.1])


@pytest.mark.parametrize("free", LAWS.values(), ids=LAWS)
def test_a_pressed_dashpot_is_that_of_the_whole_overlap(free):
    pressed = free._replace(rest=REST)
    for rate in (-2.0, 0.1):
        found, right = (dashpot.damping(law, s, rate) for law, s in ((pressed, STRAINS), (free, STRAINS + REST)))
        np.testing.assert_allclose(found, right, rtol=1e-14)
    for function in ("resistance", "growth"):
        found, right = (getattr(law, function)(s, *law) for law, s in ((pressed, STRAINS), (free, STRAINS + REST)))
        np.testing.assert_allclose(found, right, rtol=1e-14)


@pytest.mark.parametrize("free", LAWS.values(), ids=LAWS)
def test_what_it_has_given_is_the_integral_of_its_resistance_and_nothing_at_rest(free):
    for law in (free, free._replace(rest=REST), free._replace(rest=np.full(4, REST))):
        slope = (law.impulse(STRAINS + 1e-6, *law) - law.impulse(STRAINS - 1e-6, *law)) / 2e-6
        np.testing.assert_allclose(slope, dashpot.resistance(law, STRAINS), rtol=1e-8, atol=1e-9)
        assert not np.any(law.impulse(0.0, *law))
        assert not np.any(dashpot.damping(law, 0.0, 0.0))


@pytest.mark.parametrize("law", [ContactDashpot(0.3, 2.0), Viscoelastic(0.3, 2.0)], ids=["linear", "viscoelastic"])
def test_a_cut_dashpot_pulls_as_hard_as_the_contact_pushes_and_no_harder(law):
    overlap = np.array([0.0, 0.2, 0.9])
    for rate in (-1e3, -10.0):
        np.testing.assert_allclose(dashpot.damping(law, overlap, rate), -2.0 * overlap**1.5)
    weak = dashpot.damping(law, overlap[1:], -1e-3)
    np.testing.assert_allclose(weak, dashpot.damping(law._replace(floor=dashpot.NO_FLOOR), overlap[1:], -1e-3))
