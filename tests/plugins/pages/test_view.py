"""Pages of `granchain view`, without a browser: what stands in them, and what writing them leaves as it was."""

import sys

import pytest
from global_state import SCENE, assert_state_remains
from refusals import refusal

import granchain
from workflow.plugins.pages import function


def test_pages_without_bokeh_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "bokeh", None)
    assert "pip install" in refusal(["view", tmp_path], capsys)


@pytest.mark.parametrize(
    ("engine", "says"),
    [
        ("reference", "computed by the reference integrator"),
        pytest.param("lammps", "computed by LAMMPS 2", marks=pytest.mark.slow),
    ],
)
def test_a_page_says_which_engine_computed_the_run_and_states_the_verdict_as_it_is(engine, says, tmp_path):
    scene = {**SCENE, "beads": 3, "foundation": {"stiffness": 1.0}, "duration": 5.0}
    text = granchain.run(scene, tmp_path / "run", engine=engine, check=False).view().path.read_text()
    assert says in text
    assert "<p>Equipartition does not apply: no" in text
    assert ("A. P. Thompson" in text) == (engine == "lammps")


@pytest.mark.slow
def test_a_page_is_listed_shown_in_a_notebook_and_leaves_the_state_of_the_process(tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")  # bars of progress have threads
    path = granchain.run(SCENE, tmp_path / "run", engine="reference").directory.path
    assert_state_remains(lambda: granchain.view(path), path)
    assert "view.html" in granchain.open(path).directory.job.files
    shown = granchain.open(path).view()
    assert "<iframe" in shown._repr_html_()
    monkeypatch.setattr(function, "MOST_EMBEDDED", 1000)
    assert shown._repr_html_() == f'<p><a href="{shown.path.resolve().as_uri()}">{shown.path}</a></p>'
