"""What the page of a sweep draws and writes."""

import math

import pytest
from bokeh.document import Document
from bokeh.models import ColorBar, DataTable

from lammps_inputs.units import Label
from workflow.sweep.collect import QUANTITIES, Table
from workflow.view.sweep_page import layout

FIELDS = ["coupling.stiffness", "kick.velocity"]


def row(stiffness, velocity, **found):
    name = f"coupling.stiffness={stiffness},kick.velocity={velocity}"
    fields = dict(zip(FIELDS, (stiffness, velocity), strict=True))
    return {"case": name, **fields, "outcome": "done", **dict.fromkeys(QUANTITIES), "reason": None, **found}


def shown(rows):
    made = layout(
        Table(FIELDS, rows, si=True, labels={"kick.velocity": Label("kick velocity", "", "m/s")}),
        {one["case"]: "" for one in rows},
    )
    document = Document()
    document.add_root(made)
    return document


@pytest.fixture
def page():
    rows = [row(0.0285418299448364, 1), row(0.1, 1, amplitude=0.3), row(0.4, 1, amplitude=0.1)]
    return shown(rows)


def test_a_case_without_a_number_is_blank_in_the_table_drawn_nowhere_and_said(page):
    data = page.get_model_by_name("cases").data
    assert data["amplitude"] == [None, 0.3, 0.1]
    assert data["x"] == [0.0285418299448364, 0.1, 0.4]
    assert math.isnan(data["y"][0])
    assert data["y"][1:] == [0.3, 0.1]
    assert page.get_model_by_name("plot log").title.text == "1 of 3 cases have no number here"


def test_columns_are_as_wide_as_their_longest_text(page):
    widths = {column.title: column.width for column in page.select_one({"type": DataTable}).columns}
    pixels = 7  # of a letter of the table's font, on average
    assert widths["case"] > pixels * len("coupling.stiffness=0.0285418299448364,kick.velocity=1")
    assert all(width > pixels * len(title) for title, width in widths.items())
    assert widths["outcome"] < 100


@pytest.mark.parametrize(("values", "ends"), [((1, 2.5), (1, 2.5)), (("low", "high"), None)])
def test_points_have_the_colour_of_the_second_field_whose_values_can_be_chosen(page, values, ends):
    two = shown([row(stiffness, value) for stiffness in (0.1, 0.2) for value in values])
    colour = next(iter(two.select({"name": "points"}))).glyph.fill_color
    (bar,) = two.select({"type": ColorBar})
    assert (colour.field, bar.title) == ("kick.velocity", "kick.velocity (m/s)")
    assert bar.color_mapper is colour.transform
    found = (bar.color_mapper.low, bar.color_mapper.high) if ends else tuple(bar.color_mapper.factors)
    assert found == (ends or values)
    assert two.get_model_by_name("only kick.velocity").options == ["all", *map(str, values)]
    assert list(page.select({"type": ColorBar})) == []  # all have one velocity
