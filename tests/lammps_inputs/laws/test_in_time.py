"""Laws of force in time: their own calculus, and what a deck writes of them."""

import math

import numpy as np
import pytest
from mirror import opposite

from lammps_inputs.laws.in_time import HalfSine, Rectangular, Sine, make_table

LAWS = {
    "half-sine": HalfSine(0.7, 2.3),
    "rectangular": Rectangular(0.7, 2.3),
    "sine": Sine(0.7, 2.9, 0.4),
    "table": make_table(np.array([0.0, 0.4, 1.1, 2.0]), np.array([0.2, 0.9, -0.3, 0.0])),
    "table that begins later": make_table(np.array([0.5, 1.1, 2.0]), np.array([0.0, 0.7, 0.0])),
}


@pytest.mark.parametrize("name", LAWS)
def test_impulse_and_travel_are_the_integrals_of_the_force(name):
    law = LAWS[name]
    t = np.linspace(0.0, 3.0, 300001)
    middle, step = 0.5 * (t[1:] + t[:-1]), t[1]
    impulse = np.concatenate([[0.0], np.cumsum(law.force(middle, *law)) * step])
    np.testing.assert_allclose(law.impulse(t, *law), impulse, rtol=0, atol=2e-5)  # a jump within a step
    travel = np.concatenate([[0.0], np.cumsum(law.impulse(middle, *law)) * step])
    np.testing.assert_allclose(law.travel(t, *law), travel, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_the_rate_is_the_slope_of_the_force_between_kinks(name):
    law = LAWS[name]
    t = np.linspace(0.003, 3.0, 97)
    t = t[np.min(np.abs(t[:, None] - np.array(law.kinks)), axis=1) > 1e-5]
    slope = (law.force(t + 1e-6, *law) - law.force(t - 1e-6, *law)) / 2e-6
    np.testing.assert_allclose(law.rate(t, *law), slope, rtol=0, atol=1e-8)


def test_the_momentum_of_a_half_sine_is_two_thirds_of_a_rectangle_s_and_more():
    law = HalfSine(0.7, 2.3)
    assert law.impulse(99.0, *law) == law.total == pytest.approx(2.0 * 0.7 * 2.3 / math.pi, rel=1e-15)


@pytest.mark.parametrize("name", LAWS)
def test_the_total_counts_all_of_the_force_or_half_a_swing_of_one_that_never_ends(name):
    law = LAWS[name]
    last = law.kinks[-1]
    t = np.linspace(0.0, math.pi / law.omega if math.isinf(last) else last, 300001)
    size = np.abs(law.force(0.5 * (t[1:] + t[:-1]), *law))
    assert law.total == opposite(law).total == pytest.approx(float(np.sum(size)) * t[1], rel=1e-6)


@pytest.mark.parametrize("name", LAWS)
def test_what_a_deck_gives_in_a_step_is_the_impulse_around_it(name):
    """The formula read as LAMMPS does."""
    law, h = LAWS[name], 0.01
    known = {"PI": math.pi, "sin": math.sin, "cos": math.cos, "v_timestep": h}
    for line in law.variables("push"):
        _, variable, _, value = line.split()
        known[f"v_{variable}"] = float(value)
    formula = law.formula("push").replace("^", "**")
    for step in (1, 7, 40, 77, 110, 199):
        start, end = (step - 0.5) * h, (step + 0.5) * h
        given = law.impulse(end, *law) - law.impulse(start, *law)
        found = eval(formula, {**known, "step": step, "v_pushfrom": start, "v_pushto": end})
        assert found == pytest.approx(given, rel=1e-10, abs=1e-15)
