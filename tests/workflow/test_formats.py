"""Formats and width of figures: PNG of their own width, or what `--formats` and `--width` ask for."""

import struct

import pytest

import granchain
from workflow.cli import main


@pytest.fixture
def ran(tmp_path, draw_only):
    """A run of a few beads; of its figures only one is drawn."""
    scene = {"name": "tiny", "beads": 4, "kick": {"velocity": 1.0}, "duration": 2.0}
    draw_only("response")
    return granchain.run(scene, tmp_path / "run", engine="reference").directory.path


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


def inches(png):
    """Width of a PNG with 200 pixels an inch."""
    return struct.unpack(">I", png.read_bytes()[16:20])[0] / 200.0


def test_figures_have_the_width_that_is_asked_for(ran):
    assert main(["analyze", str(ran), "--quiet", "--width", "3.4"]) == 0
    assert inches(ran / "response.png") == pytest.approx(3.4, abs=0.01)
