"""Stated errors of speeds, lags, widths and residuals hold: what closer frames or smaller steps change is less."""

import itertools

import errors_between_frames as errors
import numpy as np
import pytest

from analysis.tracking.leading_waves import lags, with_speeds
from analysis.tracking.pulses import local_speed, local_speed_error

LEAST = 0.95
"""Share of passages in which an uncertainty holds."""

DERIVED = ("speed", "lag", "width", "residual")


def share(comparisons, quantity):
    """In which the error is at most the stated one, and the number of those with both."""
    both = [(each.error[quantity], each.bound[quantity]) for each in comparisons]
    error, bound = (np.concatenate(values) for values in zip(*both, strict=True))
    known = np.isfinite(error)
    assert np.isfinite(bound[known]).all()
    return np.mean(error[known] <= bound[known]), np.sum(known)


def test_the_error_of_a_speed_is_the_largest_that_errors_of_arrivals_make():
    bead, arrival, error = np.array([1, 2, 3, 5]), np.array([0.0, 1.5, 2.5, 5.0]), np.array([0.0, 0.3, 0.1, 0.2])
    moved = np.array([arrival + error * sign for sign in itertools.product([-1, 1], repeat=4)])
    speeds = np.array([local_speed(bead, times) for times in moved])
    largest = np.max(np.abs(speeds - local_speed(bead, arrival)), axis=0)
    np.testing.assert_allclose(local_speed_error(bead, arrival, error), largest, rtol=1e-12)


@pytest.mark.parametrize("late", [2.0, np.inf, np.nan])
def test_a_speed_whose_arrivals_may_be_at_one_time_has_no_error(late):
    error = local_speed_error(np.array([1, 2, 3]), np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.1, late]))
    assert np.isnan(error).tolist() == [False, True, True]


def test_where_no_speed_is_defined_neither_is_its_error():
    """Bead 3 is passed before bead 2 in chain 1, and another pulse leads from bead 3 on in chain 2."""
    chain, bead, pulse = np.repeat([1, 2], 4), np.tile([1, 2, 3, 4], 2), np.array([1, 1, 1, 1, 1, 1, 2, 2])
    arrival = np.array([0.0, 2.0, 1.5, 4.0, 0.0, 1.0, 2.0, 3.0])
    waves = with_speeds(chain, bead, arrival, np.full(8, 0.5), pulse, np.full(8, 1e-3))
    assert np.isnan(waves.speed).tolist() == [False, True, True, False, False, True, True, False]
    np.testing.assert_array_equal(np.isnan(waves.speed), np.isnan(waves.speed_error))


def test_a_lag_has_the_errors_of_both_arrivals_and_none_behind_itself():
    chain, bead = np.array([1, 1, 2, 2, 2]), np.array([2, 3, 2, 3, 4])
    waves = with_speeds(chain, bead, 1.0 * bead, np.full(5, 0.5), arrival_error=np.array([0.1, 0.2, 0.4, np.inf, 0.5]))
    assert lags(waves, 1).error.tolist() == pytest.approx([0.0, 0.0, 0.5, np.inf, np.nan], nan_ok=True)


@pytest.fixture(scope="module")
def of_frames():
    """A chain that dissipates, between walls, and two coupled ones, with frames 0.1 T, 0.5 T and 1 T apart."""
    runs = [errors.integrated(errors.small(name, 0.05).problem()) for name in ("damped-contacts", "two-chains")]
    return [each for run in runs for each in errors.compared(run, (0.1, 0.5, 1.0))]


@pytest.mark.slow
@pytest.mark.parametrize("quantity", DERIVED)
def test_numbers_of_closer_frames_differ_by_no_more_than_the_stated_errors(of_frames, quantity):
    held, count = share(of_frames, quantity)
    assert count > 300
    assert held >= LEAST


@pytest.mark.slow
@pytest.mark.parametrize("quantity", DERIVED)
def test_numbers_of_the_reference_differ_from_those_of_time_steps_by_no_more_than_the_stated_errors(quantity):
    scenes = [errors.small(name, errors.OF_RUN) for name in ("damped-contacts", "two-chains")]
    held, count = share([errors.of_steps(scene) for scene in scenes], quantity)
    assert count > 100
    assert held >= LEAST
