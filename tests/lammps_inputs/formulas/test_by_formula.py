"""Forces by formula: what may be written, what follows from it; their motion is also in `test_every_ingredient`."""

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from plain_scene import one_chain, scene

from lammps_inputs import InputError, laws, physics
from lammps_inputs.formulas.expression import names
from lammps_inputs.formulas.formula_law import Force, FormulaLaw, reach
from lammps_inputs.limits import rates

MAGNETS = {"force": "A/(d+s)^p", "A": 1.0, "p": 4.0, "d": 1.0}
HELD = {"left": "bead", "right": "bead"}


@pytest.mark.parametrize("force", ["k*((s+0.1)^2-0.01)", "k*(s+0.3)^3-k*0.027"])
def test_a_force_at_rest_by_rounding_of_its_terms_is_none(force):
    assert abs(Force(force, (("k", 0.3),)).at(0.0)) > 0.0
    assert Force(force, (("k", 0.3),)).at_rest == 0.0


FORMULAS = {
    "k*s+c*s^3+f": (),
    "k*(s+d)^3-k*d^3": (),
    "k*s+c*s^3/(1-s/d)^2": ("d",),
    "k*s+c*s/(s-d)+c*s/d": ("d",),
    "k*s/(d^2-s^2)": ("d", "-d"),
    "k*tan(s/d)": ("pi*d/2", "-pi*d/2"),
    "k*log(1+s/d)": ("-d",),
    "k*sinh(s/d)-f": (),
}
"""Forces, and where they are infinite."""

NUMBERS = st.sampled_from([0.0, 1e-14, 1e-6, 0.01, 0.3])


@pytest.mark.slow
@settings(max_examples=16, derandomize=True, database=None, deadline=None, phases=(Phase.explicit, Phase.generate))
@given(st.sampled_from(sorted(FORMULAS)), st.sampled_from([0.07, 0.5, 3.0]), NUMBERS, NUMBERS, st.floats(0.2, 5.0))
def test_springs_by_formula_have_that_force_at_every_strain_that_the_energy_reaches_or_are_refused(force, k, c, f, d):
    """A force at rest that is left out, or a pole within reach, would be another problem in each engine."""
    numbers = {name: value for name, value in {"k": k, "c": c, "f": f, "d": d}.items() if name in names(force)}
    at_rest = numbers.get("f", 0.0) != 0.0
    refused, made = "", None
    try:
        made = one_chain(foundation={"force": force, **numbers})
    except InputError as error:
        refused = str(error)
    assert ("at s = 0, where beads rest" in refused) == at_rest
    if made is None:
        return
    law, unit, energy = made.system.ground[0].law, made.scale, physics.energy(made.system)
    if not isinstance(law, FormulaLaw):  # k s
        return
    for side in (1.0, -1.0):
        far = min(reach(law, energy, side), 1e3)
        assert not any(0.0 < side * eval(pole, {"d": d, "pi": np.pi}) < far * unit.length for pole in FORMULAS[force])
        s = side * far * np.linspace(0.0, 1.0, 4001)
        push = eval(force.replace("^", "**"), {"s": s * unit.length, **vars(np), **numbers}) / unit.force
        np.testing.assert_allclose(laws.force(law, s), push, rtol=1e-9, atol=1e-12 * np.max(np.abs(push)))


@pytest.mark.slow
def test_a_formula_of_a_known_law_is_that_law_to_the_last_bit():
    plain, written = scene(coupling={"stiffness": 0.1}), scene(coupling={"force": "k*s", "k": 0.1})
    assert written.problem() == plain.problem()
    contacts = {"force": "A*s^p", "A": 2.0, "p": 1.3}, {"exponent": 1.3, "stiffness": 2.0}
    spheres = {"force": "A*s^1.5", "A": 1.0}, None
    for one, other in (contacts, spheres):
        assert one_chain(contact=one).system == one_chain(contact=other).system
    ground = [scene(foundation=keys).system for keys in ({"stiffness": 0.2}, {"force": "k*s", "k": 0.2})]
    assert ground[0] == ground[1]
    assert scene(coupling={"force": "k*s", "k": 0.0}).system == scene(coupling=None).system


@pytest.mark.slow
def test_the_sign_of_the_strain_of_contacts_follows_from_where_they_push_harder():
    apart, closer = (
        one_chain(contact=keys, walls=HELD).system.along[0].law for keys in (MAGNETS, {**MAGNETS, "force": "A/(d-s)^p"})
    )
    strain = np.linspace(-1.0, 0.3, 27)
    np.testing.assert_allclose(laws.force(apart, strain), laws.force(closer, strain), rtol=1e-13)
    np.testing.assert_allclose(
        laws.force(apart, strain), 0.5 * (1.0 - 0.5 * strain) ** -4.0 - 0.5, rtol=1e-12, atol=1e-13
    )
    assert apart.load == 0.5


@pytest.mark.slow
def test_contacts_that_touch_at_rest_pull_only_where_tension_is_allowed():
    toda = {"force": "a*(exp(-b*s)-1)", "a": 0.7, "b": 1.3}
    for tension, pull in ((None, 0.0), ("allowed", 0.7 * np.expm1(-0.13))):
        keys = toda if tension is None else {**toda, "tension": tension}
        made = one_chain(contact=keys)
        link, unit = made.system.along[0], made.scale
        assert laws.force(link.law, -0.1 / unit.length) * unit.force == pytest.approx(pull, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "largest"),
    [("k*s/sqrt(1+(s/s0)^2)", 0.3), ("k*s*(1+(s/s0)^2)", None), ("k*s0*sin(s/s0)", 0.3)],
)
def test_the_bound_of_the_step_takes_the_largest_stiffness_within_reach_of_the_energy(force, largest):
    system = scene(foundation={"force": force, "k": 0.3, "s0": 0.5}).system
    law = system.ground[0].law
    far = float(np.max(law.max_strain(0.5, *law)))
    if largest is None:  # it stiffens: at the strain that holds all of the energy
        largest = 0.3 * (1.0 + 3.0 * (far / 0.5) ** 2)
        assert 0.3 * far**2 * (0.5 + (far / 0.5) ** 2 / 4.0) == pytest.approx(0.5, rel=1e-12)
    assert laws.stiffest(law, 0.5) == pytest.approx(largest, rel=1e-12)
    assert rates.fastest(system) > rates.fastest(scene().system)


@pytest.mark.slow
@pytest.mark.parametrize("force", ["k*s/sqrt(1+(s/s0)^2)", "k*tanh(s/s0)", "k*s*abs(s)/s0"])
def test_the_energy_is_the_integral_of_the_force_whether_or_not_sympy_has_a_form_of_it(force):
    law = scene(foundation={"force": force, "k": 0.3, "s0": 0.5}).system.ground[0].law
    s = np.linspace(-1.5, 1.5, 3001)
    push = laws.force(law, s)
    simpson = np.cumsum((push[:-2:2] + 4.0 * push[1:-1:2] + push[2::2]) * (s[1] - s[0]) / 3.0)
    held = laws.energy(law, s)[::2]
    np.testing.assert_allclose(held[1:] - held[0], simpson, atol=1e-9)
    np.testing.assert_allclose(np.gradient(push, s)[1:-1], laws.stiffness(law, s)[1:-1], atol=1e-3)
