"""Formats of figures: PNG, or what `--formats` asks for."""

import pytest

from workflow import api
from workflow.cli import main


@pytest.fixture
def ran(tmp_path, draw_only):
    """A run of a few beads; of its figures only one is drawn."""
    scene = {"name": "tiny", "beads": 4, "kick": {"velocity": 1.0}, "duration": 2.0}
    draw_only("response")
    return api.run(scene, tmp_path / "run", engine="reference").directory.path


def drawn(path):
    return {file.name for file in path.glob("response.*")}


@pytest.mark.slow
def test_figures_are_those_asked_for_and_none_of_ours_is_left_that_is_older(ran):
    for words, files in (
        ([], {"response.png"}),
        (["--formats", "svg,pdf"], {"response.svg", "response.pdf"}),
        (["--no-figures"], {"response.svg", "response.pdf"}),
    ):
        assert main(["analyze", str(ran), "--quiet", *words]) == 0
        assert drawn(ran) == files


def test_a_figure_of_the_users_own_stays(ran):
    (ran / "response.pdf").write_text("mine")
    assert main(["analyze", str(ran), "--quiet"]) == 0
    assert (ran / "response.pdf").read_text() == "mine"
    assert main(["analyze", str(ran), "--quiet", "--formats", "pdf"]) == 2
