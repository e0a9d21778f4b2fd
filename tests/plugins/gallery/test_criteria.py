"""The rule of the gallery's verdicts."""

import math

import pytest

from workflow.plugins.gallery.criteria import MeasuredQuantity, at_least, at_most, near, state


def judged(found, required, lammps=0.682):
    return state(MeasuredQuantity("V", {"lammps": lammps, "reference": found}, required, "4 V"), published="0.682 V.")


@pytest.mark.parametrize(
    ("found", "holds"),
    [(0.6818, "holds"), (0.6826, "holds with a correction"), (0.7, "does not hold"), (float("nan"), "does not hold")],
)
def test_a_number_holds_in_its_range_and_needs_a_correction_in_the_wider_one(found, holds):
    statement = judged(found, near(0.682, 5e-4, 1e-3))
    assert statement.holds == holds
    assert statement.correction == ("" if holds == "holds" else f"It is {found:.4f} V.")
    assert "required: 0.682 ± 0.0005 V (± 0.001 V)" in statement.found[0]


@pytest.mark.parametrize(
    ("required", "text", "holds"),
    [
        (at_least(0.68), "≥ 0.68 V", "holds"),
        (at_most(0.68), "≤ 0.68 V", "does not hold"),
        (at_most(0.68, 0.69), "≤ 0.68 V (≤ 0.69 V)", "holds with a correction"),
        (at_least(0.7, -math.inf), "≥ 0.7 V (any value)", "holds with a correction"),
    ],
)
def test_a_bound_is_stated_as_it_is_applied(required, text, holds):
    statement = judged(0.682, required)
    assert statement.found[0].endswith(f"required: {text}")
    assert statement.holds == holds


def test_the_worse_engine_decides():
    assert judged(0.682, near(0.682, 5e-4), lammps=0.7).holds == "does not hold"


def test_the_worst_quantity_decides():
    good, bad = (MeasuredQuantity("n", {"reference": value}, near(1.0, 0.5)) for value in (1.0, 2.0))
    assert [state(good, one, derived="n is 1").holds for one in (good, bad)] == ["holds", "does not hold"]
