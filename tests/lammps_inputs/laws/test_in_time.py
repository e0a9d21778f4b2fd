"""Laws in time: their own calculus, motions through points, and what a deck writes of them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mirror import opposite

from lammps_inputs.laws import in_time
from lammps_inputs.laws.in_time import Oscillation, half_sine, of_force, rectangular, sine
from lammps_inputs.loads import Motion

FORCES = {
    "half-sine": half_sine(0.7, 2.3),
    "rectangular": rectangular(0.7, 2.3),
    "sine": sine(0.7, 2.9, 0.4),
    "table": of_force(np.array([0.0, 0.4, 1.1, 2.0]), np.array([0.2, 0.9, -0.3, 0.0])),
    "table that begins later": of_force(np.array([0.5, 1.1, 2.0]), np.array([0.0, 0.7, 0.0])),
}
MOTIONS = {
    "oscillation": Oscillation(0.3, 2.9, 0.4),
    "piston": in_time.constant_velocity(0.4),
    "piston for a while": in_time.constant_velocity(-0.4, 0.7, 2.1),
    "velocities": in_time.of_velocity(np.array([0.5, 1.1, 2.0]), np.array([0.2, -0.7, 0.1])),
    "displacements": in_time.of_displacement(np.array([0.5, 1.1, 2.0, 2.2, 2.7]), np.array([0.0, 0.2, 0.1, 0.3, 0.3])),
    "three displacements": in_time.of_displacement(np.array([0.0, 1.1, 2.0]), np.array([0.0, 0.2, 0.1])),
}
LAWS = FORCES | MOTIONS


def jumps(law, t):
    """Sum of the jumps of the velocity until times, which are no integral of the acceleration."""
    leaps = np.array(law.leaps)
    sizes = [law.impulse(leap, *law) - law.impulse(leap - 1e-7, *law) for leap in leaps]
    return sum((size * (t >= leap) for leap, size in zip(leaps, sizes, strict=True)), 0.0 * t)


@pytest.mark.parametrize("name", LAWS)
def test_impulse_and_travel_are_the_integrals_of_the_force(name):
    law = LAWS[name]
    t = np.linspace(0.0, 3.0, 300001)
    middle, step = 0.5 * (t[1:] + t[:-1]), t[1]
    impulse = np.concatenate([[0.0], np.cumsum(law.force(middle, *law)) * step]) + jumps(law, t)
    start = law.impulse(0.0, *law), law.travel(0.0, *law)
    np.testing.assert_allclose(law.impulse(t, *law), start[0] + impulse, rtol=0, atol=2e-5)  # a jump within a step
    travel = np.concatenate([[0.0], np.cumsum(law.impulse(middle, *law)) * step])
    np.testing.assert_allclose(law.travel(t, *law), start[1] + travel, rtol=0, atol=step if law.leaps else 1e-9)


@pytest.mark.parametrize("name", LAWS)
def test_the_rate_is_the_slope_of_the_force_between_kinks(name):
    law = LAWS[name]
    t = np.linspace(0.003, 3.0, 97)
    t = t[np.min(np.abs(t[:, None] - np.array(law.kinks)), axis=1) > 1e-5]
    slope = (law.force(t + 1e-6, *law) - law.force(t - 1e-6, *law)) / 2e-6
    np.testing.assert_allclose(law.rate(t, *law), slope, rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", FORCES)
def test_the_total_counts_all_of_the_force_or_half_a_period_of_one_that_never_ends(name):
    law = LAWS[name]
    last = law.kinks[-1]
    t = np.linspace(0.0, math.pi / law.omega if math.isinf(last) else last, 300001)
    size = np.abs(law.force(0.5 * (t[1:] + t[:-1]), *law))
    assert law.total == opposite(law).total == pytest.approx(float(np.sum(size)) * t[1], rel=1e-6)


@pytest.mark.parametrize("name", MOTIONS)
def test_the_fastest_velocity_is_the_largest_of_all_times(name):
    law = LAWS[name]
    velocity = law.impulse(np.linspace(0.0, 3.0, 300001), *law)
    assert law.fastest == -opposite(law).fastest
    assert abs(law.fastest) == pytest.approx(np.max(np.abs(velocity)), rel=1e-3)  # a maximum just before a jump
    assert abs(law.fastest) >= np.max(np.abs(velocity)) * (1.0 - 1e-12)


def lammps_reads(text, law, name, **known):
    """A formula read as LAMMPS does."""
    names = {"PI": math.pi, "sin": math.sin, "cos": math.cos, **known}
    for line in law.variables(name):
        _, variable, _, value = line.split()
        names[f"v_{variable}"] = float(value)
    return eval(text.replace("^", "**"), names)


@pytest.mark.parametrize("name", FORCES)
def test_what_a_deck_gives_in_a_step_is_the_impulse_around_it(name):
    law, h = LAWS[name], 0.01
    for step in (1, 7, 40, 77, 110, 199):
        start, end = (step - 0.5) * h, (step + 0.5) * h
        impulse = law.impulse(end, *law) - law.impulse(start, *law)
        known = {"step": step, "v_timestep": h, "v_pushfrom": start, "v_pushto": end}
        assert lammps_reads(law.formula("push"), law, "push", **known) == pytest.approx(impulse, rel=1e-10, abs=1e-15)


@pytest.mark.parametrize("name", ["oscillation", "piston", "piston for a while"])
def test_what_a_deck_moves_a_bead_to_is_the_motion_also_at_the_step_at_which_it_changes(name):
    law, h = LAWS[name], 0.1
    motion = Motion(1, 1, (law,))
    for step in (0, 1, 7, 20, 21, 25):
        course = [lammps_reads(text, law, "d", step=step, v_timestep=h) for text in law.course("d")]
        assert course == pytest.approx([motion.displacement(step * h), motion.velocity(step * h)], rel=1e-9, abs=1e-15)


def test_velocities_between_points_of_a_sine_are_off_by_an_eighth_of_its_curvature_times_the_distance_squared():
    omega, points = 0.7, 201
    time = np.linspace(0.0, 20.0, points)
    h = time[1]
    law = in_time.of_velocity(time, np.sin(omega * time))
    t = np.linspace(0.0, 20.0, 10 * points)
    bound = (omega * h) ** 2 / 8.0
    error = np.max(np.abs(law.impulse(t, *law) - np.sin(omega * t)))
    assert 0.9 * bound < error <= bound * (1.0 + 1e-9)
    # the trapezoidal rule, whose error is that of the integral alone: h^2 / 12 times the change of the slope
    exact = (1.0 - np.cos(omega * time)) / omega
    change = h**2 / 12.0 * omega * (np.cos(omega * time) - 1.0)
    np.testing.assert_allclose(law.travel(time, *law) - exact, change, rtol=0.0, atol=(omega * h) ** 4 * 20.0 / 720.0)


def test_displacements_between_points_of_a_sine_are_off_by_five_384ths_of_the_fourth_derivative():
    omega, size = 0.7, 0.3
    errors = []
    for points in (51, 101, 201):
        time = np.linspace(0.0, 20.0, points)
        law = in_time.of_displacement(time, size * np.sin(omega * time))
        t = np.linspace(5.0, 15.0, 20 * points)  # far from the ends, whose influence falls by 2 - sqrt(3) a point
        errors.append(np.max(np.abs(law.travel(t, *law) - size * np.sin(omega * t))))
        # a spline has 1/384 between equidistant points of a sine, and 5/384 by the bound of Hall & Meyer (1976)
        assert errors[-1] <= 5.0 / 384.0 * size * (omega * time[1]) ** 4
        assert law.impulse(0.0, *law) == pytest.approx(size * omega, rel=0.2 * (omega * time[1]) ** 3)
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(4.0, abs=0.15)


numbers = st.floats(-1e3, 1e3)


@pytest.mark.slow
@given(st.lists(st.tuples(st.floats(1e-3, 1e3), numbers), min_size=1, max_size=20), st.booleans())
def test_a_motion_passes_through_all_points_whatever_these_are(rows, velocities):
    widths, values = np.array(rows).T
    time, values = np.concatenate([[0.0], np.cumsum(widths)]), np.concatenate([[0.0], values])
    make, function = (in_time.of_velocity, "impulse") if velocities else (in_time.of_displacement, "travel")
    law = make(time, values)
    slope = np.max(np.abs(law.value)) if velocities else abs(law.fastest)
    atol = 1e-9 * (1.0 + max(map(abs, values))) + 2e-12 * time[-1] * slope  # points are that much earlier
    np.testing.assert_allclose(getattr(law, function)(time, *law), values, rtol=0.0, atol=atol)
    late = np.array([2.0, 3.0]) * time[-1]
    assert np.ptp(law.impulse(late, *law)) == 0.0
    assert np.all(np.abs(law.impulse(np.linspace(0.0, time[-1], 99), *law)) <= abs(law.fastest) * (1.0 + 1e-12))


def test_a_piston_moves_with_its_velocity_from_its_begin_to_its_end():
    motion = Motion(1, 1, (MOTIONS["piston for a while"],))
    assert [motion.velocity(time) for time in (0.6, 1.4, 2.2)] == [0.0, -0.4, 0.0]
    assert [motion.displacement(time) for time in (0.6, 1.4, 2.2)] == pytest.approx([0.0, -0.28, -0.56], abs=1e-9)
