"""Panels are data without a drawing library, and are drawn alike: one legend, and labels that panels share once."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from analysis.figures.drawing import draw
from analysis.figures.panels import BEAD, Axis, Curve, Image, Panel, Sheet, curves_of
from lammps_inputs.units import Label

TIME = np.arange(30.0)
SECONDS, SPEED = Axis(Label("time", "t", "s")), Axis(Label("speed", "v", "m/s"))
LINES = curves_of([0, 2], TIME, np.stack([TIME, 2.0 * TIME], axis=1))
PANEL = Panel(SECONDS, SPEED, LINES, "bead 5")


def drawn(*rows, **options):
    return draw(Sheet("of a run", rows, 4.0, **options))


def test_panels_of_a_run_and_of_its_measurements_import_no_drawing_library():
    modules = "analysis.figures.waves, workflow.measures.registry, workflow.plugins.export.figure_numbers"
    code = f"import sys, {modules}; list(workflow.measures.registry.MEASUREMENTS); print('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "False\n"


def test_a_label_that_panels_share_stands_once_and_others_beside_their_panels():
    figure = drawn([PANEL, PANEL], [PANEL, None])
    assert [axis.get_xlabel() for axis in figure.axes] == ["", "time $t$ (s)", "time $t$ (s)"]
    assert (figure.get_supylabel(), {axis.get_ylabel() for axis in figure.axes}) == ("speed $v$ (m/s)", {""})
    figure = drawn([PANEL], [replace(PANEL, y=BEAD)])
    assert (figure.get_supylabel(), [axis.get_ylabel() for axis in figure.axes]) == ("", ["speed $v$ (m/s)", "bead"])


def test_a_name_is_once_in_the_legend_and_a_single_one_has_none():
    other = replace(PANEL, curves=(*LINES, Curve("sum", TIME, TIME, look={"color": "black"})))
    (legend,) = drawn([PANEL], [other]).legends
    assert [text.get_text() for text in legend.get_texts()] == ["chain 1", "chain 3", "sum"]
    assert drawn([replace(PANEL, curves=LINES[:1])]).legends == []


@pytest.mark.parametrize(("heights", "letters"), [((), "abcd"), ((2.0, 1.0), "ab"), ((2.0, 2.0), "abcd")])
def test_panels_have_letters_but_for_rows_that_belong_to_the_one_above(heights, letters):
    titles = [axis.get_title(loc="left") for axis in drawn([PANEL] * 2, [PANEL] * 2, heights=heights).axes]
    assert titles == [*(f"({letter}) bead 5" for letter in letters), *["bead 5"] * (4 - len(letters))]


def test_layers_lie_on_each_other_and_points_that_stand_alone_are_dots():
    layers = tuple(Curve(name, TIME, np.full(30, height)) for name, height in (("a", 1.0), ("b", 2.0)))
    figure = drawn([replace(PANEL, curves=(), layers=layers)])
    assert [area.get_paths()[0].get_extents().y1 for area in figure.axes[0].collections] == [1.0, 3.0]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["b", "a"]  # as they lie
    gaps = np.where(TIME % 5 < 3, TIME, np.nan)
    gaps[20:25] = [np.nan, np.nan, 7.0, np.nan, np.nan]
    _, dots = drawn([replace(PANEL, curves=(Curve("chain 1", TIME, gaps, place=0),))]).axes[0].get_lines()
    assert dots.get_xdata().tolist() == [22.0]


def test_the_bar_of_an_image_names_its_values_and_the_legend_what_has_none():
    image = Image(np.array([[0.0, np.nan]]), (0.5, 2.5), (0.0, 1.0), Label("speed", "v"), (-1.0, 1.0), True, "gone")
    figure = drawn([Panel(BEAD, SECONDS, image=image)])
    assert figure.axes[-1].get_ylabel() == "speed $v$; colour: signed square root"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["gone"]
