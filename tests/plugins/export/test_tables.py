"""Tables as CSV and Parquet, figures as SVG and PDF, and the numbers behind figures."""

import csv
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

import granchain
from analysis.figures.panels import BEAD, Axis, Curve, Image, Marks, Panel
from lammps_inputs.units import Label
from workflow.plugins.export.figure_numbers import BAND, caption, columns_of


def rows(path):
    return list(csv.reader(path.read_text().splitlines()))


def test_csv_holds_the_table_of_waves_and_numbers_of_every_panel(run_of, tmp_path):
    run = run_of("coupled")
    paths = granchain.export(run, "csv", tmp_path / "out")
    names = {path.name for path in paths}
    assert {"waves.csv", "figure-spacetime-1.csv", "figure-spacetime-2.csv", "figure-response-1.csv"} <= names
    assert (tmp_path / "out/waves.csv").read_text() == granchain.analyze(run).waves.to_csv()
    head, *numbers = rows(tmp_path / "out/figure-spacetime-2.csv")
    assert head[:3] == ["series", "bead", "time t (reduced)"]
    assert head[3].startswith("velocity v (reduced)")
    velocities = np.array([float(row[3]) for row in numbers]).reshape(-1, 12)
    np.testing.assert_array_equal(velocities, run.trajectory.velocity[:, 1])


def test_parquet_holds_the_columns_of_the_csv_with_units_and_null_where_it_is_empty(run_of, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed (granchain[export])")
    run = run_of("steel")
    granchain.export(run, ["parquet", "csv"], tmp_path)
    for name in ("waves", "forces"):
        table = parquet.read_table(tmp_path / f"{name}.parquet")
        head, *lines = rows(tmp_path / f"{name}.csv")
        assert table.column_names == head
        for heading, texts in zip(head, zip(*lines, strict=True), strict=True):
            written = ["" if value is None else value for value in table[heading].to_pylist()]
            assert written == [type(value)(text) for value, text in zip(written, texts, strict=True)]
    assert "arrival (s)" in parquet.read_table(tmp_path / "waves.parquet").column_names


@pytest.mark.usefixtures("pool_here")
def test_a_sweep_is_exported_as_its_table(tmp_path):
    scene = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
    table = granchain.sweep({"scene": scene, "vary": {"beads": [8, 9]}, "engine": "reference"}, tmp_path / "swept")
    [path] = granchain.export(tmp_path / "swept", "csv")
    assert path == tmp_path / "swept/table.csv"
    assert path.read_text() == table.to_csv()


@pytest.mark.slow
def test_figures_are_vector_graphics_with_their_numbers_beside_them(run_of, tmp_path):
    paths = granchain.export(run_of("short"), "svg,pdf", tmp_path)
    names = {path.name for path in paths}
    assert {"response.svg", "response.pdf", "figure-response-1.csv"} <= names
    assert ET.parse(tmp_path / "response.svg").getroot().tag.endswith("svg")
    assert (tmp_path / "response.pdf").read_bytes().startswith(b"%PDF")


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
