"""For scripts and notebooks: the same as the commands, with results that show themselves."""

import csv
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import FunctionType

import numpy as np
import pytest
from notebook import NOTEBOOK, executed

import granchain
from lammps_inputs import InputError, Scene, library
from lammps_inputs.units import DIMENSIONLESS, Label
from workflow.cli import COMMANDS, main
from workflow.quantities.columns import QUANTITIES

SCENE = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
STEEL = SCENE | {
    "material": {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
    "duration": 1e-4,
}


SWEEP = {"scene": SCENE, "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}


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
    return granchain.run(STEEL, tmp_path_factory.mktemp("granchain") / "run")


def test_a_scene_comes_by_name_file_data_or_as_it_is(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(json.dumps(SCENE))
    assert granchain.load(path) == granchain.load(str(path)) == granchain.load(SCENE) == Scene(**SCENE)
    assert granchain.load("two-chains") == library.find("two-chains")
    assert granchain.load(granchain.load(SCENE)) == Scene(**SCENE)


def test_a_scene_is_loaded_with_other_values_of_fields_which_are_checked():
    scene = granchain.load("two-chains", {"coupling.stiffness": 0.2, "chains": 3})
    assert (scene.coupling.stiffness, scene.chains, scene.beads) == (0.2, 3, 120)
    assert granchain.load(scene, {"beads": 9}).beads == 9
    for field, says in (("kappa", r"did you mean `coupling\.stiffness`"), ("chains", "chains: should be greater")):
        with pytest.raises(InputError, match=says):
            granchain.load("two-chains", {field: -3})


def test_contacts_that_stay_elastic_have_no_figure_of_permanent_overlaps(tmp_path):
    material = {"name": "steel", "radius": 4.76e-3, "yield_strength": 1e12}
    scene = {"name": "elastic", "beads": 8, "material": material, "kick": {"velocity": 0.1}, "duration": 2e-4}
    analysis = granchain.analyze(granchain.run(scene, tmp_path / "run", engine="reference"), figures=True)
    assert "budget.png" in {path.name for path in map(Path, analysis.figures)}
    assert "plastic.png" not in {path.name for path in map(Path, analysis.figures)}


def test_a_run_is_a_universe_with_values_in_si(ran):
    found = granchain.universe(ran.directory.path)
    assert found.segments.segids.tolist() == ["C1"]
    for number, ts in enumerate(found.trajectory):
        np.testing.assert_array_equal(ts.data["si"].velocity, ran.si.velocity[number].ravel())
    assert number == len(ran.si.time) - 1


def test_mistakes_raise_our_error_and_never_exit(tmp_path):
    with pytest.raises(granchain.InputError, match="scene: beads"):
        granchain.load(SCENE | {"beads": 1})
    with pytest.raises(granchain.InputError, match="no such"):
        granchain.analyze(tmp_path / "nothing")
    Path(tmp_path / "scene.yaml").write_text(json.dumps(SCENE))
    (tmp_path / "chains.dump.bin").write_bytes(b"")
    with pytest.raises(granchain.InputError, match=r"chains\.dump\.bin: is an empty file"):
        granchain.universe(tmp_path)


def test_a_deck_is_that_of_the_command(tmp_path):
    path = granchain.deck(SCENE, tmp_path / "deck")
    (tmp_path / "scene.yaml").write_text(json.dumps(SCENE))
    assert main(["deck", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "by-command"), "-q"]) == 0
    assert path.read_text() == (tmp_path / "by-command" / "in.chains").read_text()


def test_every_name_of_the_module_is_there_and_has_a_docstring():
    assert set(granchain.__all__) < set(dir(granchain))
    for name in set(dir(granchain)) - {"materials", "__version__"}:
        assert getattr(granchain, name).__doc__, name
    with pytest.raises(AttributeError, match="module 'granchain' has no attribute 'analyse'"):
        granchain.analyse  # noqa: B018


def test_functions_have_the_names_of_commands_but_for_those_that_no_command_has():
    functions = {name for name in dir(granchain) if isinstance(getattr(granchain, name), FunctionType)}
    assert functions - set(COMMANDS) == {"load", "open", "plot", "resume", "statistics", "trace_file", "universe"}


def test_what_a_scene_leaves_open_is_found(tmp_path):
    scene = {key: value for key, value in SCENE.items() if key != "duration"} | {"until_bead": 6}
    found = granchain.run(scene, str(tmp_path / "run"), engine="reference")
    assert found.directory.problem.duration > 4.0


def test_numbers_of_a_run_are_had_in_its_own_units(ran):
    scale, frames = ran.directory.problem.scale, ran.trajectory
    assert np.array_equal(ran.si.velocity, frames.velocity * scale.velocity)
    assert np.array_equal(ran.si.displacement, frames.displacement * scale.length)
    assert ran.si.time[-1] == pytest.approx(1e-4, rel=0.01)


def test_waves_are_the_table_of_the_file_in_the_units_of_the_scene(ran):
    waves = granchain.analyze(ran).waves
    with (ran.directory.path / "waves.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == [waves.heading(name) for name in waves.columns]
    assert head[3] == "arrival (s)"
    array = waves.array()
    for name, written in zip(waves.columns, zip(*rows, strict=True), strict=True):
        numbers = [float(cell or "nan") for cell in written]
        np.testing.assert_array_equal(getattr(waves, name), numbers)
        np.testing.assert_array_equal(array[name], numbers)
        assert name in dir(waves)


def test_waves_in_units_of_v_and_t_are_those_of_the_survey(ran):
    analysis = granchain.analyze(ran)
    scale = ran.directory.problem.scale
    np.testing.assert_array_equal(analysis.waves.arrival, analysis.survey.waves.arrival * scale.time)


def test_waves_are_a_data_frame_if_pandas_is_there(ran):
    pd = pytest.importorskip("pandas")
    waves = granchain.analyze(ran).waves
    written = pd.read_csv(ran.directory.path / "waves.csv")
    pd.testing.assert_frame_equal(waves.pandas(), written, check_dtype=False)


def test_a_run_its_error_its_validation_and_its_scene_show_themselves(ran):
    judged = granchain.validate(ran.directory.path)
    for shown, words in (
        (ran, "lammps"),
        (ran.check, "velocities (V)"),
        (judged, "momentum"),
        (granchain.load(STEEL), "radius"),
        (granchain.analyze(ran, figures=False), "peak velocity (m/s)"),
        (granchain.analyze(ran, figures=False).waves, "peak_velocity (m/s)"),
    ):
        assert any(words in text for text in Cells(shown._repr_html_()).text)
        assert len(repr(shown)) < 200
        assert repr(shown).startswith("<")


def test_a_notebook_shows_the_table_of_the_leading_pulse_that_the_command_prints_clear_of_the_free_end(ran, capsys):
    shown = Cells(granchain.analyze(ran, figures=False)._repr_html_()).text
    capsys.readouterr()
    assert main(["analyze", str(ran.directory.path), "--no-figures"]) == 0
    printed = capsys.readouterr().out.partition("leading pulse")[2].splitlines()
    first, last = (line.split() for line in printed[2:4])
    assert (first[0], last[0]) == ("2", "3")  # five beads before the free end
    assert set(first + last) <= set(shown)
    assert str(STEEL["beads"]) not in shown


def test_what_holds_many_numbers_says_how_many_in_a_line(ran):
    frame = granchain.universe(ran).trajectory[2].data["si"]
    for shown in (ran.si, ran.trajectory, granchain.analyze(ran, figures=False).waves, frame):
        assert len(repr(shown)) < 200
        assert repr(shown).startswith("<")


@pytest.mark.slow
@pytest.mark.usefixtures("pool_here")
def test_a_sweep_is_a_table_as_array_and_as_pandas_if_that_is_there(tmp_path):
    what = {"scene": SCENE, "vary": {"kick.velocity": [1.0, 2.0]}, "engine": "reference"}
    found = granchain.sweep(what, tmp_path / "swept", jobs=1)
    array = found.array()
    assert array["kick.velocity"].tolist() == [1.0, 2.0]
    assert array["engine"].tolist() == ["reference", "reference"]
    assert array["outcome"].tolist() == ["done", "done"]
    assert "kick.velocity (reduced)" in Cells(found._repr_html_()).text
    pd = pytest.importorskip("pandas")
    assert isinstance(found.pandas(), pd.DataFrame)


def test_heads_of_tables_in_a_notebook_have_units_also_reduced_ones(ran):
    steel = granchain.analyze(ran, figures=False).waves
    assert {"arrival (s)", "peak_velocity (m/s)", "width (beads)", "bead"} <= set(Cells(steel._repr_html_()).text)
    assert [steel.unit(name) for name in ("arrival", "width", "residual", "bead")] == ["s", "beads", "", ""]
    reduced = replace(steel, scale=DIMENSIONLESS)
    assert {"arrival (reduced)", "width (beads)"} <= set(Cells(reduced._repr_html_()).text)


def test_a_table_of_a_sweep_shows_its_units_and_its_plot_over_one_or_two_fields():
    def table(*fields):
        names = ["case", *fields, "outcome", *QUANTITIES, "reason"]
        rows = [
            dict.fromkeys(names)
            | {"case": f"c{a}{b}", "outcome": "done", "amplitude": 0.1 * (a + b)}
            | dict(zip(fields, (a, b), strict=False))
            for a in (1, 2)
            for b in ((1, 2) if len(fields) > 1 else (1,))
        ]
        labels = {name: Label(name, "", "m") for name in fields}
        return granchain.SweepTable(list(fields), rows, si=False, labels=labels)

    for fields, pictures in ((("a",), 1), (("a", "b"), 1), (("a", "b", "c"), 0)):
        shown = table(*fields)._repr_html_()
        assert shown.count('<img src="data:image/png') == pictures
        assert {"a (m)", "amplitude (V)"} <= set(Cells(shown).text)


def test_progress_in_a_notebook_is_one_line_that_is_replaced(tmp_path):
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    code = f"import granchain\ngranchain.sweep({SWEEP!r}, 'swept', jobs=1)\nNone"
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    nbclient.NotebookClient(book, resources={"metadata": {"path": str(tmp_path)}}).execute()
    assert [output["output_type"] for output in book.cells[0].outputs] == ["display_data"]


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
    assert "equipartitioned" in repr(names["analysis"])
    assert len(names["table"].rows) == 3


def _words(output):
    """Kind and text of an output without its numbers; of a picture that there is one."""
    texts = {"text/plain": output.get("text", []), **output.get("data", {})}
    return {
        kind: kind == "image/png" or re.sub(r'src="data:[^"]*"|[-+.\d]+(e[-+]?\d+)?|\s+', "", "".join(text))
        for kind, text in texts.items()
    }
