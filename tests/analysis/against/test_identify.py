"""Digits, shifts in time and springs, measured on numbers of which they are known."""

from dataclasses import replace

import numpy as np
import pytest
from analysis.against.symptoms import SINGLE, identify_springs, precision, time_shift
from hypothesis import given
from hypothesis import strategies as st
from small_problems import problem, written_down

from lammps_inputs.ingredients import coupled_chains
from workflow.engines.reference import engine

NUMBERS = np.random.default_rng(1).normal(size=500) * 10.0 ** np.random.default_rng(2).integers(-6, 3, 500)


# --- digits -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("digits", range(2, 13))
def test_numbers_of_some_digits_are_recognised(digits):
    assert precision(np.array([float(f"{value:.{digits}g}") for value in NUMBERS])) == f"{digits} digits"


@pytest.mark.parametrize("decimals", range(6, 10))
def test_numbers_of_some_decimals_are_recognised(decimals):
    assert precision(np.round(NUMBERS[np.abs(NUMBERS) > 1e-3], decimals)) == f"{decimals} decimals"


def test_single_precision_is_recognised():
    assert precision(NUMBERS.astype(np.float32).astype(np.float64)) == SINGLE


@pytest.mark.parametrize("digits", [15, 16, 17])
@pytest.mark.parametrize("far", [1.0, 1e6, 1e12])
def test_numbers_of_all_digits_pass_however_far_from_zero(digits, far):
    assert precision(np.array([float(f"{value:.{digits}g}") for value in far + NUMBERS * np.sqrt(2.0)])) is None


def test_rounding_survives_taking_rest_positions_off():
    rest = np.arange(1, 501) * 4.0
    position = np.array([float(f"{value:.3f}") for value in rest + 0.9 * NUMBERS / (1.0 + np.abs(NUMBERS))])
    assert precision(position - rest) == "3 decimals"


def test_single_precision_survives_taking_rest_positions_off_and_on():
    rest = np.arange(1, 501) * 4.909090909090909
    position = (NUMBERS + rest).astype(np.float32).astype(np.float64)
    assert precision((position - rest) + rest) == SINGLE


def test_whole_numbers_nan_and_few_others_tell_nothing():
    assert precision(np.array([*range(1000), np.nan, np.inf, *np.arange(19) + 0.5])) is None


def test_one_number_over_and_over_tells_nothing():
    assert precision(np.full(1000, 0.3)) is None


# --- shifts -----------------------------------------------------------------------------------------------------------


@given(st.floats(1e-9, 0.05), st.sampled_from([-1.0, 1.0]), st.floats(0.1, 3.0))
def test_a_shift_is_found_with_its_sign(shift, sign, frequency):
    t = np.linspace(0.0, 40.0, 2001)[:, np.newaxis, np.newaxis]
    ahead = np.sin(frequency * (t + sign * shift))
    found = time_shift(ahead - np.sin(frequency * t), frequency * np.cos(frequency * t))
    # sin(a (t + s)) - sin(a t) = sin(a s) cos(a t) - (1 - cos(a s)) sin(a t); over 40 the last is at right angles to
    # the rate but for |sin(80 a)| / (4 a) of a sum of squares above 13
    assert found.time == pytest.approx(sign * shift, rel=(frequency * shift) ** 2 / 6.0 + shift / 13.0 + 1e-6)
    assert found.explained > 1.0 - (frequency * shift) ** 2 - 1e-9


def test_a_difference_at_right_angles_to_the_rate_is_no_shift():
    t = np.arange(1000) * 2.0 * np.pi / 1000.0
    assert time_shift(np.sin(t), np.cos(t)).explained < 1e-20


@pytest.mark.parametrize(("difference", "rate"), [(0.0, 1.0), (1.0, 0.0), (0.0, 0.0)])
def test_nothing_is_no_shift(difference, rate):
    assert time_shift(np.full(9, difference), np.full(9, rate)).explained == 0.0


# --- springs ----------------------------------------------------------------------------------------------------------


LEFT_BY_CONTACTS = 2e-5
"""Stiffness that frames of 0.1 feign in the rows that moved a hundredth of those that moved most."""


def felt(kappa, claimed=0.1, **changes):
    """Springs identified in a run with one coupling of a problem that claims another."""
    run = engine.run(problem(kappa=kappa, **changes), steps_per_frame=16)
    return identify_springs(
        replace(
            run,
            problem=replace(
                run.problem, system=replace(run.problem.system, links=coupled_chains(run.problem.chains, claimed))
            ),
        )
    )


@pytest.mark.parametrize(("kappa", "chains"), [(0.01, 2), (0.1, 3), (0.5, 5), (3.0, 2)])
def test_the_coupling_of_every_spring_is_found(kappa, chains):
    found = felt(kappa, chains=chains, beads=20, frames=200)
    moved = np.isfinite(found.linear)
    assert moved.sum() >= 5 * (chains - 1)
    # trapezoids with corrected ends: what they leave of the contacts' impulses counts most where a row moved least
    np.testing.assert_allclose(found.linear[moved], kappa, rtol=2e-3, atol=LEFT_BY_CONTACTS)
    assert np.median(found.linear[moved]) == pytest.approx(kappa, rel=2e-4)
    assert found.cubic == 0.0


def test_without_springs_none_are_felt():
    found = felt(0.0, beads=20)
    assert np.nanmax(np.abs(found.linear)) < LEFT_BY_CONTACTS


def test_springs_of_a_cubic_force_are_found_cubic():
    run = written_down(problem(chains=2, beads=2, kicks=((1, 1, 1.0),), gap=100.0), lambda t: (0.0 * t, 0.0 * t))
    state, h, frames = np.array([0.0, 1.0]), 1e-3, []
    for step in range(run.problem.frames * 100 + 1):  # x'' = -2 * 0.03 x^3, for the distance of two beads of mass 1
        if step % 100 == 0:
            frames.append(state.copy())
        half = state[1] - 0.5 * h * 0.06 * state[0] ** 3
        state[0] += h * half
        state[1] = half - 0.5 * h * 0.06 * state[0] ** 3
    x, v = np.array(frames).T
    displacement, velocity = np.zeros_like(run.displacement), np.zeros_like(run.velocity)
    displacement[:, 0, 0], displacement[:, 1, 0] = x / 2.0, -x / 2.0
    velocity[:, 0, 0], velocity[:, 1, 0] = v / 2.0, -v / 2.0
    found = identify_springs(replace(run, displacement=displacement, velocity=velocity))
    assert found.cubic == pytest.approx(0.03, rel=1e-3)


@pytest.mark.parametrize(
    "changes", [{"chains": 1, "kappa": 0.0}, {"frames": 8}, {"kicks": ((1, 1, 1.0), (2, 1, 1.0))}, {"recorded": (1, 2)}]
)
def test_where_springs_cannot_be_told_nothing_is_said(changes):
    assert identify_springs(engine.run(problem(**changes))) is None
