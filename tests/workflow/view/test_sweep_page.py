"""What the page of a sweep draws and writes."""

import math

import pytest
from bokeh.document import Document
from bokeh.models import ColorBar, DataTable, Plot

from lammps_inputs.units import Label
from workflow.sweep.collect import QUANTITIES, SweepTable
from workflow.view.sweep_page import layout

FIELDS = ["coupling.stiffness", "kick.velocity"]


def row(stiffness, velocity, **found):
    name = f"coupling.stiffness={stiffness},kick.velocity={velocity}"
    fields = dict(zip(FIELDS, (stiffness, velocity), strict=True))
    return {"case": name, **fields, "outcome": "done", **dict.fromkeys(QUANTITIES), "reason": None, **found}


def shown(rows, files=()):
    table = SweepTable(FIELDS, rows, si=True, labels={"kick.velocity": Label("kick velocity", "", "m/s")})
    made, _ = layout(table, {one["case"]: list(files) for one in rows}, "swept")
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


def test_points_have_bars_of_their_uncertainty_and_are_hollow_where_chains_have_not_settled():
    rows = [
        row(0.02, 1, amplitude=0.356, amplitude_uncertainty=0.053, state="beating"),
        row(0.1, 1, amplitude=0.365, amplitude_uncertainty=0.001, state="equipartitioned and synchronised"),
        row(0.4, 1, amplitude=0.36, state="beating"),
    ]
    data = shown(rows).get_model_by_name("cases").data
    assert data["low"] == pytest.approx([0.303, 0.364, 0.36])
    assert data["high"] == pytest.approx([0.409, 0.366, 0.36])
    assert data["solid"] == [0.0, 1.0, 0.0]
    (column,) = (one for one in shown(rows).select_one({"type": DataTable}).columns if one.field == "amplitude")
    assert "&plusmn;" in column.formatter.template
    assert "amplitude_uncertainty" in column.formatter.template


def test_the_plot_has_room_for_notes_between_its_toolbar_and_its_axes(page):
    for plot in page.select({"type": Plot}):
        assert plot.title.text  # of an empty one Bokeh's layout has no height, also when it is set later


def test_cases_link_to_their_page_or_else_their_first_figure_or_nowhere():
    for files, link in ((("view.html", "distance.png"), "view.html"), (("distance.png",), "distance.png"), ((), "")):
        data = shown([row(0.1, 1, amplitude=0.3)], files).get_model_by_name("cases").data
        assert data["link"] == [f"{data['case'][0]}/{link}" if link else ""]
        assert data["files"][0].count("<a href=") == len(files)


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
    assert (colour.field, bar.title) == ("kick.velocity", "kick velocity (m/s)")
    assert bar.color_mapper is colour.transform
    found = (bar.color_mapper.low, bar.color_mapper.high) if ends else tuple(bar.color_mapper.factors)
    assert found == (ends or values)
    assert two.get_model_by_name("only kick.velocity").options == ["all", *map(str, values)]
    assert list(page.select({"type": ColorBar})) == []  # all have one velocity
