"""Where quantities are found: help, the manual's page, columns of a sweep's table."""

from pathlib import Path

import pytest

from analysis.quantity import walk
from lammps_inputs.units import SI
from workflow.measures import MEASUREMENTS
from workflow.verdicts import quantities
from workflow.verdicts.places import OWN, collect_columns, places
from workflow.verdicts.quantities import explained, manual

PAGE = Path(__file__).parents[3] / "analysis" / "QUANTITIES.md"
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


def test_the_manuals_page_is_what_the_types_declare():
    assert PAGE.read_text(encoding="utf-8") == manual(), (
        "python -m workflow.verdicts.quantities > analysis/QUANTITIES.md"
    )


def test_every_quantity_has_a_meaning_and_a_unit_that_is_known():
    assert [place for place in places() if not place.quantity.meaning] == []
    assert {place.quantity.unit for place in places()} - SI.keys() - LITERAL == set()


@pytest.mark.parametrize("kind", MEASUREMENTS)
def test_a_measurement_declares_what_stands_under_its_key(kind):
    assert list(walk(kind.kind))
    assert kind.table is None or list(walk(kind.table[1]))


def test_help_says_of_a_column_unit_meaning_when_undefined_and_where():
    lines = [line.strip() for line in (explained("wall_force") or "").splitlines()]
    assert lines[0] == "wall_force"
    assert lines[1].startswith("largest force on the far wall")
    assert "unit: N with a material, else reduced" in lines
    assert any(line.startswith("undefined where: there is no wall") for line in lines)
    assert lines[-2:] == ["analysis.json: far_end > wall_force", "granchain collect: column wall_force"]


def test_help_says_symbol_and_every_place_of_a_name():
    text = explained("arrival") or ""
    assert "symbol: t" in text
    assert all(place in text for place in ("analysis.json: waves > arrival", "waves.csv: column arrival", "run.json"))
    assert explained("no_such") is None


def test_a_column_reads_the_value_that_its_quantity_declares():
    found = collect_columns()["agree_1"]
    assert (found.file, found.path) == ("analysis.json", ("equipartition", "amplitudes", "0.01"))
    assert collect_columns()["arrival"].path == ("kicked", "arrival")


def test_names_of_columns_are_those_of_one_quantity():
    names = [column.name for place in quantities.places() for column in place.quantity.columns]
    assert len(names) == len(set(names))
