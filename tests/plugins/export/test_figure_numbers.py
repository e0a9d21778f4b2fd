"""The numbers behind a figure are those of its panels, under the labels of their axes."""

from dataclasses import replace

import numpy as np

from analysis.figures.panels import BEAD, Axis, Curve, Image, Marks, Panel
from lammps_inputs.units import Label
from workflow.plugins.export.figure_numbers import BAND, caption, columns_of

TIME, SPEED = np.array([0.0, 1.0, 2.0]), np.array([3.0, np.nan, 5.0])
TIMES, RATIO = Axis(Label("time", "t", "ms")), Axis(Label("ratio", "c\\,(t_\\mathrm{peak})"))


def test_curves_and_layers_have_the_names_of_the_legend_and_labels_without_tex():
    layers = (Curve("kinetic", TIME[:1], np.array([4.0])), Curve("contacts", TIME[:1], np.array([0.5])))
    panel = Panel(
        TIMES, RATIO, (Curve("$\\propto n^{2}$", TIME, SPEED),), marks=(Marks([1.0], "no number"),), layers=layers
    )
    table = columns_of(panel)
    assert list(table) == ["series", "time t (ms)", "ratio c (t_peak)"]
    assert table["series"] == ["propto n^2"] * 3 + ["kinetic", "contacts"]
    np.testing.assert_array_equal(table["time t (ms)"], [*TIME, 0.0, 0.0])
    np.testing.assert_array_equal(table["ratio c (t_peak)"], [*SPEED, 4.0, 0.5])  # each has its own, not their sum


def test_an_image_has_the_middles_of_its_pixels_and_the_label_of_the_colours():
    values = np.arange(6.0).reshape(2, 3)
    image = Image(values, (0.5, 3.5), (0.0, 4.0), Label("velocity", "v"), (0.0, 5.0), signed=True)
    panel = Panel(BEAD, TIMES, image=image)
    heading = "velocity v; colour: signed square root"
    table = columns_of(panel)
    np.testing.assert_array_equal(table["bead"], [1.0, 2.0, 3.0] * 2)
    np.testing.assert_array_equal(table["time t (ms)"], [1.0] * 3 + [3.0] * 3)
    np.testing.assert_array_equal(table[heading], values.ravel())
    assert (
        caption(panel, "(a) chain 1", "two\nchains") == f"{heading} over bead and time t (ms); (a) chain 1; two chains"
    )


def test_a_band_has_half_of_its_height_where_there_is_one():
    curve = Curve("chain 1", TIME, SPEED)
    table = columns_of(Panel(TIMES, RATIO, (replace(curve, spread=0.5 * TIME), curve)))
    np.testing.assert_array_equal(table[BAND], [0.0, 0.5, 1.0, np.nan, np.nan, np.nan])
    assert columns_of(Panel(TIMES, RATIO, (Curve("chain 1", TIME[:0], SPEED[:0]),))) == {}
