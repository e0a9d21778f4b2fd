"""Gaps that differ from contact to contact: by number, as a list, or at random."""

import math

import numpy as np
import pytest
from plain_scene import one_chain

from lammps_inputs import library
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import StepHalving
from workflow.sweep import fields


def gapped(gap, **changes):
    return one_chain(**{"beads": 6, "gap": gap, "duration": 8.0, **changes})


@pytest.mark.parametrize(
    ("short", "listed"), [({"contacts": {3: 0.3, "1": 0.1}}, [0.1, 0.0, 0.3, 0.0, 0.0]), (0.2, [0.2] * 5)], ids=str
)
def test_gaps_in_short_are_those_of_a_list_also_when_written_again(short, listed):
    case, expected = gapped(short), gapped(listed).system
    assert case.system == expected
    assert library.from_plain(case.plain(), "test").system == expected


def test_random_gaps_are_factors_of_numpy_on_their_mean():
    case = gapped({"mean": 0.2, "spread": 0.5, "seed": 7}, chains=2)
    factors = np.random.default_rng(7).uniform(0.5, 1.5, (2, 5))
    np.testing.assert_array_equal(case.problem().system.along[0].gap, 0.2 * factors)


def test_a_single_gap_is_a_field_of_sweeps():
    plain = gapped({"contacts": {1: 0.1, 3: 0.3}}).plain()
    changed = library.from_plain(fields.put_all(plain, {"gap.contacts.3": 0.4}), "test")
    np.testing.assert_array_equal(changed.gaps, [[0.1, 0.0, 0.4, 0.0, 0.0]])
    assert fields.label(fields.parse("gap.contacts.3", plain), plain).plain == "gap, contact 3 (reduced)"


def test_a_collision_of_two_spheres_with_gaps_delays_the_second_by_half_its_duration():
    """Until bead 2 meets bead 3 it is where a bead of velocity 1 would be that waited for half the collision."""
    gaps, problem = (0.4, 7.0), gapped([0.4, 7.0], beads=3, duration=9.0, output={"every": 0.1}).problem()
    # duration of a collision of reduced mass 1/2 with the force overlap^1.5, at velocity 1 (Hertz 1882)
    lasts = 0.8 * math.sqrt(math.pi) * math.gamma(0.4) / math.gamma(0.9) * (1.25 * 0.5) ** 0.4
    motion, sure = engine.run(problem), StepHalving(problem).run().velocity
    flies = (motion.time > gaps[0] + lasts) & (motion.time < sum(gaps) + 0.5 * lasts)
    assert np.count_nonzero(flies) > 30
    expected = motion.time[flies] - gaps[0] - 0.5 * lasts
    np.testing.assert_allclose(motion.velocity[flies, 0], [[0.0, 1.0, 0.0]] * np.count_nonzero(flies), atol=sure)
    np.testing.assert_allclose(motion.displacement[flies, 0, 1], expected, atol=sure * problem.duration)
