"""What stands in which column of a sweep's table, in which order of rows: by files made by hand; labels in units."""

import pytest

from lammps_inputs import Scene
from workflow.quantities.columns import QUANTITIES
from workflow.sweep import fields
from workflow.sweep.collect import SweepTable


@pytest.mark.parametrize(("other", "same"), [(2.0005, True), (2.005, False)])
def test_bands_are_drawn_where_all_cases_have_them(other, same):
    rows = [{"case": "a"}, {"case": "b"}]
    bands = {"a": [[0.0, 1.0], [1.5, 2.0]], "b": [[0.0, 1.0], [1.5, other]]}
    table = SweepTable(["drive.frequency"], rows, False, bands=bands)
    assert (table.passed("drive.frequency") is not None) == same
    assert table.passed("gap") is None


SI = {"material": {"radius": 1e-3}}


def test_columns_and_fields_have_their_own_label_unit_and_bounds(golden):
    """Of quantities in SI; of fields in SI and reduced, and between what they lie."""
    lines = [f"{name}: {quantity.unit(si=True) or 'no unit'}" for name, quantity in QUANTITIES.items()]
    for name in fields.all_fields(Scene):
        parts = fields.parse(name.replace("kinds.", "kinds.light."))
        reduced, si = (fields.label(parts, scene) for scene in ({}, SI))
        assert not set(reduced.words) & set("._"), name
        lines.append(f"{name}: {si.plain}; {reduced.plain}; {fields.bounds(parts)}")
    golden("labels", "\n".join(lines))


@pytest.mark.parametrize(("law", "unit"), [("linear", "kg/s"), ("viscoelastic", "kg/(s m^0.5)"), ("restitution", "")])
def test_the_unit_of_damped_contacts_is_that_of_their_law(law, unit):
    assert fields.unit(fields.parse("damping.contact"), SI | {"damping": {"law": law}}) == unit
