"""Where quantities are found, and columns of a sweep's table."""

import pytest

from analysis.quantity import walk
from lammps_inputs.units import SI
from workflow.measures.registry import MEASUREMENTS
from workflow.verdicts.places import OWN, collect_columns, places

LITERAL = {
    "",
    *OWN,
    "kg, m, s, m/s",
    "beads",
    "rows",
    "energy input",
    "rad/bead",
    "m",
    "m/s",
    "N",
    "Pa",
    "s",
    "that of the quantity",
}


def test_every_quantity_has_a_meaning_and_a_unit_that_is_known():
    assert [place for place in places() if not place.quantity.meaning] == []
    assert {place.quantity.unit for place in places()} - SI.keys() - LITERAL == set()


@pytest.mark.parametrize("kind", MEASUREMENTS)
def test_a_measurement_declares_what_stands_under_its_key(kind):
    assert list(walk(kind.kind))
    assert kind.table is None or list(walk(kind.table[1]))


def test_a_column_reads_the_value_that_its_quantity_declares():
    found = collect_columns()["agree_1"]
    assert (found.file, found.path) == ("analysis.json", ("equipartition", "amplitudes", "0.01"))
    assert collect_columns()["arrival"].path == ("kicked", "arrival")


def test_names_of_columns_are_those_of_one_quantity():
    names = [column.name for place in places() for column in place.quantity.columns]
    assert len(names) == len(set(names))
