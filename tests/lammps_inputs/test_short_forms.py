"""Short forms of a scene: counts in patterns, overlap in place of a load, mass and constant in place of a material."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_scene import one_chain as scene

from analysis import motion
from lammps_inputs import library, strict_yaml

COUNTS = st.lists(st.tuples(st.sampled_from("ab"), st.integers(1, 30), st.booleans()), min_size=1, max_size=6)
SIZES = st.floats(1e-6, 1e6)


@pytest.mark.slow
@given(st.lists(COUNTS, min_size=1, max_size=2))
def test_counts_in_a_pattern_give_the_scene_of_the_pattern_written_out(rows):
    short = [[f"{count}*{name}" if brief else name for name, count, brief in row] for row in rows]
    long = [[name for name, count, brief in row for _ in range(count if brief else 1)] for row in rows]
    keys = {"chains": len(rows), "beads": 20, "kinds": {"a": {}, "b": {"mass": 0.5}}}
    one, other = (scene(**keys, pattern=pattern if len(rows) > 1 else pattern[0]) for pattern in (short, long))
    assert one == other
    assert library.from_plain(strict_yaml.parse(strict_yaml.dump(one.plain()), "again"), "again") == one


@pytest.mark.slow
@pytest.mark.parametrize("overlap", [1e-3, 0.07, 1.0])
@pytest.mark.parametrize(("exponent", "strength", "stiffness"), [(1.0, 3.0, 1.0), (1.5, 1.0, 1e7), (3.0, 0.25, 1.0)])
def test_an_overlap_is_the_load_under_which_all_contacts_overlap_so_far(overlap, exponent, strength, stiffness):
    """The bound is that of `static_load.FINEST` in the force, whose places are those that LAMMPS holds."""
    contact = {"exponent": exponent, "strength": strength, "stiffness": stiffness}
    held = scene(contact=contact, precompression={"overlap": overlap})
    force = strength * stiffness * overlap**exponent
    same = scene(contact=contact, precompression={"force": force})
    rest, other = (float(np.max(case.system.along[0].law.rest)) for case in (held, same))
    assert rest * held.scale.length == pytest.approx(overlap, rel=1e-4)
    assert rest == pytest.approx(other, rel=1e-6)


@pytest.mark.slow
@settings(deadline=None, max_examples=20)
@given(mass=SIZES, constant=SIZES, velocity=st.floats(1e-3, 1e3), exponent=st.sampled_from([1.5, 1.0, 2.5]))
def test_beads_by_mass_and_constant_have_the_dimensionless_problem_of_beads_of_mass_1(
    mass, constant, velocity, exponent
):
    """With L = (m V^2 / A)^(1 / (p + 1)) and T = L / V: the scaling is exact."""
    length = (mass * velocity**2 / constant) ** (1.0 / (exponent + 1.0))
    time, force = length / velocity, mass * velocity**2 / length
    si = scene(
        mass=mass,
        contact={"exponent": exponent, "stiffness": constant},
        kinds={"light": {"mass": 0.5 * mass}, "plain": {}},
        pattern=["plain", "2*light"],
        kick={"velocity": velocity},
        duration=20.0 * time,
        output={"every": 0.5 * time},
    )
    kinds = {"light": {"mass": 0.5}, "plain": {}}
    reduced = scene(contact={"exponent": exponent}, kinds=kinds, pattern=["plain", "2*light"])
    assert si.scale.si
    assert (si.scale.mass, si.scale.velocity) == (mass, velocity)
    assert (si.scale.time, si.scale.force) == pytest.approx((time, force), rel=1e-12)
    strain = np.linspace(0.0, 1.0, 24).reshape(1, 24)[:, :12]
    rates = [motion.acceleration(case.system, strain) for case in (si, reduced)]
    np.testing.assert_allclose(*rates, rtol=1e-6, atol=1e-8)
    assert si.problem().timestep == pytest.approx(reduced.problem().timestep, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        (
            {"contact": {"stiffness": 1.05e7}, "duration": 1.0},
            "contact.stiffness in N/m^1.5? 1.05e+07 in reduced units",
        ),
        ({"contact": {"stiffness": 1.05e7}, "mass": 18.3, "duration": 1.0}, "mass in kg? 18.3 kg"),
    ],
)
def test_a_mass_in_grams_and_a_constant_without_mass_are_named(changes, warning):
    assert any(text.startswith(warning) for text in scene(output={}, **changes).unlikely)
