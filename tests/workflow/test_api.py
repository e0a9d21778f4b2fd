"""For scripts and notebooks: the same as the commands, with results that show themselves."""

import csv
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from notebook import NOTEBOOK, executed

from lammps_inputs import Scene, library
from workflow import api
from workflow.cli import main

SCENE = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
STEEL = SCENE | {
    "material": {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
    "duration": 1e-4,
}


class Cells(HTMLParser):
    """Text of a piece of HTML; every tag that is opened must be closed."""

    def __init__(self, html):
        super().__init__()
        self.open, self.text = [], []
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag, attrs):  # noqa: ARG002
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    return api.run(STEEL, tmp_path_factory.mktemp("api") / "run")


def test_a_scene_comes_by_name_file_data_or_as_it_is(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(json.dumps(SCENE))
    assert api.load(path) == api.load(str(path)) == api.load(SCENE) == Scene(**SCENE)
    assert api.load("two-chains") == library.find("two-chains")
    assert api.load(api.load(SCENE)) == Scene(**SCENE)


def test_a_run_is_a_universe_with_values_in_si(ran):
    found = api.universe(ran.directory.path)
    assert found.segments.segids.tolist() == ["C1"]
    for number, ts in enumerate(found.trajectory):
        np.testing.assert_array_equal(ts.data["si"].velocity, ran.si.velocity[number].ravel())
    assert number == len(ran.si.time) - 1


def test_mistakes_raise_our_error_and_never_exit(tmp_path):
    with pytest.raises(api.InputError, match="scene: beads"):
        api.load(SCENE | {"beads": 1})
    with pytest.raises(api.InputError, match="no such"):
        api.analyse(tmp_path / "nothing")
    Path(tmp_path / "scene.yaml").write_text(json.dumps(SCENE))
    (tmp_path / "chains.dump.bin").write_bytes(b"")
    with pytest.raises(api.InputError, match=r"chains\.dump\.bin: is an empty file"):
        api.universe(tmp_path)


def test_what_a_scene_leaves_open_is_found(tmp_path):
    scene = {key: value for key, value in SCENE.items() if key != "duration"} | {"until_bead": 6}
    found = api.run(scene, str(tmp_path / "run"), engine="reference")
    assert found.directory.problem.duration > 4.0


def test_numbers_of_a_run_are_had_in_its_own_units(ran):
    scale, frames = ran.directory.problem.scale, ran.trajectory
    assert np.array_equal(ran.si.velocity, frames.velocity * scale.velocity)
    assert np.array_equal(ran.si.displacement, frames.displacement * scale.length)
    assert ran.si.time[-1] == pytest.approx(1e-4, rel=0.01)


def test_waves_are_a_structured_array(ran):
    waves = api.analyse(ran).waves
    found = waves.array()
    assert found.dtype.names[:3] == ("chain", "bead", "pulse")
    assert np.array_equal(found["peak_velocity"], waves.peak_velocity)


def test_waves_in_si_are_those_of_the_table(ran):
    found = api.analyse(ran, figures=False)
    with (ran.directory.path / "waves.csv").open() as file:
        rows = list(csv.DictReader(file))
    columns = {"arrival": "arrival (s)", "peak_velocity": "peak_velocity (m/s)", "speed": "speed (beads/s)"}
    for name, column in columns.items():
        written = [float(row[column] or "nan") for row in rows]
        np.testing.assert_array_equal(found.si.array()[name], written)


def test_a_run_its_error_its_validation_and_its_scene_show_themselves(ran):
    judged = api.validate(ran.directory.path)
    for shown, words in (
        (ran, "lammps"),
        (ran.check, "velocities (V)"),
        (judged, "momentum"),
        (api.load(STEEL), "radius"),
        (api.analyse(ran, figures=False), "peak velocity (m/s)"),
    ):
        assert any(words in text for text in Cells(shown._repr_html_()).text)
        assert len(repr(shown)) < 200
        assert repr(shown).startswith("<")


def test_a_notebook_shows_the_table_of_the_leading_pulse_that_the_command_prints_clear_of_the_free_end(ran, capsys):
    shown = Cells(api.analyse(ran, figures=False)._repr_html_()).text
    capsys.readouterr()
    assert main(["analyze", str(ran.directory.path), "--no-figures"]) == 0
    printed = capsys.readouterr().out.partition("leading pulse")[2].splitlines()
    first, last = (line.split() for line in printed[2:4])
    assert (first[0], last[0]) == ("2", "3")  # five beads before the free end
    assert set(first + last) <= set(shown)
    assert str(STEEL["beads"]) not in shown


def test_what_holds_many_numbers_says_how_many_in_a_line(ran):
    frame = api.universe(ran).trajectory[2].data["si"]
    for shown in (ran.si, ran.trajectory, api.analyse(ran, figures=False).waves, frame):
        assert len(repr(shown)) < 200
        assert repr(shown).startswith("<")


@pytest.mark.slow
@pytest.mark.usefixtures("pool_here")
def test_a_sweep_is_a_table_as_array_and_as_pandas_if_that_is_there(tmp_path):
    what = {"scene": SCENE, "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}
    found = api.sweep(what, tmp_path / "swept", jobs=1)
    array = found.array()
    assert array["kick.velocity"].tolist() == [1.0, 2.0]
    assert array["engine"].tolist() == ["reference", "reference"]
    assert array["outcome"].tolist() == ["done", "done"]
    assert "kick.velocity" in Cells(found._repr_html_()).text
    pd = pytest.importorskip("pandas")
    assert isinstance(found.pandas(), pd.DataFrame)


def test_what_a_name_holds_is_text_not_markup():
    from lammps_inputs import html

    assert Cells(html.table("<b>", ("<i>",), [["<script>"]])).text == ["<b>", "<i>", "<script>"]


@pytest.mark.slow
@pytest.mark.usefixtures("lammps_here", "pool_here")
def test_the_notebook_runs_and_its_saved_outputs_differ_by_numbers_only(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    for cell, saved in zip(
        *(book["cells"] for book in (executed(names), json.loads(NOTEBOOK.read_text()))), strict=True
    ):
        assert [_words(one) for one in cell.get("outputs", [])] == [_words(one) for one in saved.get("outputs", [])]
    assert "equipartitioned" in repr(names["found"])
    assert len(names["table"].rows) == 3


def _words(output):
    """Kind and text of an output without its numbers; of a picture that there is one."""
    texts = {"text/plain": output.get("text", []), **output.get("data", {})}
    return {
        kind: kind == "image/png" or re.sub(r"[-+.\d]+(e[-+]?\d+)?|\s+", "", "".join(text))
        for kind, text in texts.items()
    }


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: api.run("two-chains", None), "directory: None given; a path such as 'out'"),
        (lambda: api.run("two-chains", "out", ranks="2"), "ranks: '2' given; a whole number, 1 or more"),
        (lambda: api.analyse(3), "directory: 3 given"),
    ],
)
def test_an_argument_of_another_type_is_named(call, says):
    with pytest.raises(api.InputError, match=re.escape(says)):
        call()
