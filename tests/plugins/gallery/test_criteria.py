"""The rule of the gallery's verdicts."""

import math

import pytest

from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state

HOLDS, CORRECTED, FAILS = "holds", "holds with a correction", "does not hold"


def judged(value, required, lammps=0.682):
    return state(MeasuredQuantity("V", {"lammps": lammps, "reference": value}, required, "4 V"), published="0.682 V.")


@pytest.mark.parametrize(
    ("value", "required", "text", "holds"),
    [
        (0.6818, near(0.682, 5e-4, 1e-3), "0.682 \u00b1 0.0005 V (\u00b1 0.001 V)", HOLDS),
        (0.6826, near(0.682, 5e-4, 1e-3), "0.682 \u00b1 0.0005 V (\u00b1 0.001 V)", CORRECTED),
        (0.7, near(0.682, 5e-4, 1e-3), "0.682 \u00b1 0.0005 V (\u00b1 0.001 V)", FAILS),
        (0.682, at_least(0.68), "\u2265 0.68 V", HOLDS),
        (0.682, at_most(0.68), "\u2264 0.68 V", FAILS),
        (0.682, at_least(0.7, -math.inf), "\u2265 0.7 V (any value)", CORRECTED),
    ],
)
def test_a_number_holds_in_its_range_and_needs_a_correction_in_the_wider_one(value, required, text, holds):
    statement = judged(value, required)
    assert f"required: {text}" in statement.found[0]
    assert statement.holds == holds
    assert (statement.correction == "") == (holds == HOLDS)


def test_the_worse_engine_and_the_worst_quantity_decide():
    assert judged(0.682, near(0.682, 5e-4), lammps=0.7).holds == FAILS
    good, bad = (MeasuredQuantity("n", {"reference": value}, near(1.0, 0.5)) for value in (1.0, 2.0))
    assert [state(good, last, derived="n is 1").holds for last in (good, bad)] == [HOLDS, FAILS]
