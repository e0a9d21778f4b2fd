"""Statistics and histogram of values, compared with exact ones."""

import math

import numpy as np
import pytest

from analysis.statistics import histogram, statistics

ROUNDING = 1e-14
NAN = math.nan


def test_statistics_of_one_to_five_are_exact_and_undefined_values_are_counted_apart():
    found = statistics(np.array([3.0, NAN, 1.0, 2.0, NAN, 5.0, 4.0]))
    assert (found.values, found.undefined, found.mean, found.q50) == (5, 2, 3.0, 3.0)
    assert found.standard_deviation == pytest.approx(math.sqrt(2.5), rel=ROUNDING)
    assert found.standard_error == pytest.approx(math.sqrt(0.5), rel=ROUNDING)
    # linear between the ordered values: 1 + 4 q
    assert [found.q5, found.q25, found.q75, found.q95] == pytest.approx([1.2, 2.0, 4.0, 4.8], rel=ROUNDING)


@pytest.mark.parametrize(
    ("values", "undefined"),
    [
        ([NAN, NAN], {"mean", "standard_error", "standard_deviation", "q5", "q25", "q50", "q75", "q95"}),
        ([2.0], {"standard_error", "standard_deviation"}),
        ([0.1] * 3, set()),
    ],
)
def test_statistics_that_have_no_meaning_are_undefined(values, undefined):
    found = vars(statistics(np.array(values)))
    assert {name for name, value in found.items() if math.isnan(value)} == undefined
    if not undefined:
        assert (found["mean"], found["standard_deviation"]) == (0.1, 0.0)


@pytest.mark.parametrize(
    ("values", "bins"),
    [
        (np.random.default_rng(1).normal(size=200).tolist(), 12),
        ([3.0, NAN, 1.0, 3.0, 5.0], 4),
        ([1e20] * 3, 1),
        ([1.0, 1.0 + 2e-16], 3),
        ([NAN], 0),
    ],
)
def test_a_histogram_counts_every_value_once_between_the_smallest_and_the_largest(values, bins):
    numbers = np.array(values)
    found = histogram(numbers)
    assert len(found.count) == bins
    assert found.count.sum() == np.isfinite(numbers).sum()
    np.testing.assert_array_equal(found.low[1:], found.high[:-1])
    for low, high, count in zip(found.low[:-1], found.high[:-1], found.count[:-1], strict=True):
        assert count == np.sum((numbers >= low) & (numbers < high))
    if bins:
        assert (found.low[0], found.high[-1]) == (np.nanmin(numbers), np.nanmax(numbers))
