"""Tables as CSV and Parquet, figures as SVG and PDF, and the numbers behind figures."""

import csv
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import granchain


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


def test_every_file_of_numbers_of_a_figure_has_a_caption_that_names_its_quantities_and_the_case(run_of, tmp_path):
    paths = granchain.export(run_of("coupled"), "csv", tmp_path)
    head, *lines = rows(tmp_path / "figures.csv")
    assert head == ["file", "caption"]
    assert {file for file, _ in lines} == {path.name for path in paths if path.name.startswith("figure-")}
    for file, caption in lines:
        quantities = [heading for heading in rows(tmp_path / file)[0][1:] if heading not in ("x", "y", "value")]
        assert all(heading in caption for heading in quantities), file
        assert "2 chains of" in caption
        assert "V = " in caption


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


def test_figures_are_vector_graphics_with_their_numbers_beside_them(run_of, tmp_path):
    paths = granchain.export(run_of("short"), "svg,pdf", tmp_path)
    names = {path.name for path in paths}
    assert {"response.svg", "response.pdf", "figure-response-1.csv"} <= names
    assert ET.parse(tmp_path / "response.svg").getroot().tag.endswith("svg")
    assert (tmp_path / "response.pdf").read_bytes().startswith(b"%PDF")
