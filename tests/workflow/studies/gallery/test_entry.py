"""Verdicts on published numbers."""

import pytest

from workflow.studies.gallery.entry import number


@pytest.mark.parametrize(
    ("found", "holds"),
    [(0.6818, "holds"), (0.6826, "holds with a correction"), (0.7, "does not hold"), (float("nan"), "does not hold")],
)
def test_a_number_holds_within_its_rounding_and_needs_a_correction_near_it(found, holds):
    statement = number("V", 0.682, {"lammps": 0.682, "reference": found}, within=5e-4, roughly=1e-3)
    assert statement.holds == holds
    assert bool(statement.correction) == (holds != "holds")


def test_the_worse_engine_decides():
    statement = number("V", 0.682, {"lammps": 0.7, "reference": 0.682}, within=5e-4)
    assert statement.holds == "does not hold"
