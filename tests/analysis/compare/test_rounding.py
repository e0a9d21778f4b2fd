"""Digits to which numbers were rounded, measured on numbers of which they are known."""

import numpy as np
import pytest

from analysis.compare.rounding import SINGLE, precision

NUMBERS = np.random.default_rng(1).normal(size=500) * 10.0 ** np.random.default_rng(2).integers(-6, 3, 500)


@pytest.mark.parametrize("digits", [2, 3, 6, 9, 12])
def test_numbers_of_some_digits_are_recognised(digits):
    assert precision(np.array([float(f"{value:.{digits}g}") for value in NUMBERS])) == f"{digits} digits"


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
