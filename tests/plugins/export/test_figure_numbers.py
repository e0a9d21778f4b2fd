"""The numbers behind a figure are those that were drawn, under the labels of its axes."""

import numpy as np
from matplotlib.figure import Figure

from workflow.plugins.export.figure_numbers import panels

TIME, SPEED = np.array([0.0, 1.0, 2.0]), np.array([3.0, np.nan, 5.0])


def test_curves_points_and_bars_have_the_names_of_the_legend_and_labels_without_tex():
    figure = Figure()
    axis = figure.subplots()
    axis.plot(TIME, SPEED, label="chain 1")
    axis.scatter([0.5], [0.25], label="measured")
    axis.bar([1.0], [4.0], label="modes")
    axis.axhline(1.0)  # a mark, no number
    axis.set_xlabel(r"time $t$ (ms)")
    axis.set_ylabel(r"$c\,(t_\mathrm{peak})$")
    [table] = panels(figure)
    assert list(table) == ["series", "time t (ms)", "c (t_peak)"]
    assert table["series"] == ["chain 1"] * 3 + ["modes", "measured"]
    np.testing.assert_array_equal(table["time t (ms)"], [*TIME, 1.0, 0.5])
    np.testing.assert_array_equal(table["c (t_peak)"], [*SPEED, 4.0, 0.25])


def test_an_image_and_a_mesh_have_the_centres_of_their_cells_and_the_label_of_the_colours():
    values = np.arange(6.0).reshape(2, 3)
    figure = Figure()
    image, mesh = figure.subplots(1, 2)
    bar = figure.colorbar(image.imshow(values, origin="lower", extent=(0.5, 3.5, 0.0, 4.0)), ax=image)
    bar.set_label("velocity $v$")
    mesh.pcolormesh([0.5, 1.5, 2.5, 3.5], [0.0, 2.0, 4.0], values)
    for table, heading in zip(panels(figure), ("velocity v", "velocity v"), strict=True):
        np.testing.assert_array_equal(table["x"], [1.0, 2.0, 3.0] * 2)
        np.testing.assert_array_equal(table["y"], [1.0] * 3 + [3.0] * 3)
        np.testing.assert_array_equal(table[heading], values.ravel())


def test_a_label_that_panels_share_heads_the_numbers_of_each_and_an_empty_panel_has_none():
    figure = Figure()
    upper, lower, _ = figure.subplots(3, 1, sharex=True)
    upper.plot(TIME, SPEED)
    lower.fill_between(TIME, 0.0, TIME, label="range")
    lower.set_xlabel("bead")
    first, second = panels(figure)
    assert list(first) == list(second) == ["series", "bead", "y"]
    assert set(second["series"]) == {"range"}
    assert max(second["y"]) == 2.0
