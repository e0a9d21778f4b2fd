"""For scripts and notebooks: the same as the commands, with results that show themselves."""

import csv
import json
import re

import numpy as np
import pytest
from notebook import NOTEBOOK, executed

import granchain
from lammps_inputs import InputError, Scene, html, library

SCENE = {"name": "tiny", "beads": 8, "kick": {"velocity": 1.0}, "duration": 4.0}
STEEL = SCENE | {
    "material": {"radius": 4.76e-3, "density": 8000.0, "youngs_modulus": 193e9, "poisson_ratio": 0.3},
    "duration": 1e-4,
}


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


@pytest.mark.slow
def test_a_run_is_a_universe_with_values_in_si(ran):
    found = granchain.universe(ran.directory.path)
    assert found.segments.segids.tolist() == ["C1"]
    for number, ts in enumerate(found.trajectory):
        np.testing.assert_array_equal(ts.data["si"].velocity, ran.si.velocity[number].ravel())
    assert number == len(ran.si.time) - 1
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


def test_what_a_name_holds_is_text_not_markup():
    shown = html.table("<b>", ("<i>",), [["<script>"]])
    assert not any(tag in shown for tag in ("<b>", "<i>", "<script>"))


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
