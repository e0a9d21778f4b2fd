"""Where quantities are found, and columns of a sweep's table."""

from lammps_inputs.units import SI
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


def test_a_column_reads_the_value_that_its_quantity_declares():
    found = collect_columns()["agree_1"]
    assert (found.file, found.path) == ("analysis.json", ("equipartition", "amplitudes", "0.01"))
    assert collect_columns()["arrival"].path == ("kicked", "arrival")
