"""What the page of a sweep draws and writes."""

import math

import pytest
from bokeh.document import Document
from bokeh.models import ColorBar, DataTable, Plot

from lammps_inputs.units import Label
from workflow.plugins.pages.sweep_page import layout, points
from workflow.quantities.columns import QUANTITIES
from workflow.sweep.collect import SweepTable, drawn

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
    assert data["low"] == pytest.approx([0.303, 0.364, math.nan], nan_ok=True)
    assert data["high"] == pytest.approx([0.409, 0.366, math.nan], nan_ok=True)
    assert data["solid"] == [0.0, 1.0, 0.0]
    (column,) = (one for one in shown(rows).select_one({"type": DataTable}).columns if one.field == "amplitude")
    assert "&plusmn;" in column.formatter.template
    assert "amplitude_uncertainty" in column.formatter.template
    assert "not settled" in column.formatter.template
    figure = drawn(SweepTable(FIELDS, rows, si=False), "amplitude", "coupling.stiffness")
    (axis,) = figure.axes
    hollow = next(line for line in axis.lines if line.get_markerfacecolor() == "white")
    assert hollow.get_xdata().tolist() == [x for x, solid in zip(data["x"], data["solid"], strict=True) if not solid]


def test_a_case_that_is_not_done_has_no_number_on_the_page_as_in_figures():
    rows = [row(0.02, 1, amplitude=0.3), row(0.1, 1, amplitude=0.4) | {"outcome": "running"}]
    assert points(SweepTable(FIELDS, rows, si=False), "amplitude")["value"] == pytest.approx(
        [0.3, math.nan], nan_ok=True
    )
    assert points(SweepTable(FIELDS, rows, si=False), FIELDS[0])["value"] == [0.02, 0.1]


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
def test_points_have_the_colour_of_the_second_field_at_first(page, values, ends):
    two = shown([row(stiffness, value) for stiffness in (0.1, 0.2) for value in values])
    colour = next(iter(two.select({"name": "points"}))).glyph.fill_color
    (bar,) = (bar for bar in two.select({"type": ColorBar}) if bar.visible and bar.name in FIELDS)
    assert (colour.field, bar.title) == ("kick.velocity", "kick velocity (m/s)")
    assert bar.color_mapper is colour.transform
    mapper = bar.color_mapper
    assert ((mapper.low, mapper.high) if ends else tuple(mapper.factors)) == (ends or values)
    assert [key for key, _ in two.get_model_by_name("colour").options] == ["", *FIELDS]
    assert {bar.name for bar in page.select({"type": ColorBar})} == {FIELDS[0]}  # all have one velocity


def test_values_of_a_field_have_boxes_or_where_there_are_many_two_ends():
    few = shown([row(0.1, value) for value in (1, 2)])
    assert few.get_model_by_name("only kick.velocity").labels == ["1", "2"]
    many = shown([row(0.1, value) for value in range(20)])
    assert many.get_model_by_name("only kick.velocity") is None
    for end, value in (("least", "0"), ("largest", "19")):
        chooser = many.get_model_by_name(f"{end} kick.velocity")
        assert chooser.value == value
        assert [text for _, text in chooser.options] == [str(place) for place in range(20)]


def test_a_map_can_be_chosen_where_two_fields_of_numbers_vary(page):
    assert page.get_model_by_name("form") is None
    assert shown([row(0.1, "low"), row(0.2, "high")]).get_model_by_name("form") is None
    assert shown([row(0.1, 1), row(0.2, 2)]).get_model_by_name("form").options == ["points", "map"]
