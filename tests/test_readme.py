"""README and gallery show what there is."""

import io
import re
from pathlib import Path

import numpy as np
import pytest
from gallery import FOLDER, INCHES, PICTURES, small
from PIL import Image
from synthetic_waves import reference

from analysis.figures.drawing import draw
from analysis.figures.spacetime import space_time_meter, spacetime_sheet
from analysis.figures.style import picture
from lammps_inputs import installed_scenes
from workflow.formats import written_as

PAGES = ("README.md", "lammps_inputs/GALLERY.md", "lammps_inputs/SCENES.md", "analysis/README.md")
README, GALLERY, *REFERENCES = ((Path(__file__).parents[1] / page).read_text(encoding="utf-8") for page in PAGES)
SHOWN = set(re.findall(r"\]\([./]*\.github/([\w/-]+)\.png\)", "".join((README, GALLERY, *REFERENCES))))
OTHERS = {"trade", "view"}  # of one machine's speed, and of a page in a browser


def test_every_picture_is_drawn_by_the_script_and_small():
    assert set(PICTURES) == SHOWN - OTHERS
    assert all((FOLDER / f"{name}.png").stat().st_size < 60_000 for name in PICTURES)


def test_bars_of_colours_have_the_colours_of_the_figure():
    trajectory = reference(1, 0.0, 12, 12.0)
    with written_as(("png",), INCHES[0]):
        figure = draw(spacetime_sheet(space_time_meter(trajectory.problem).read([trajectory])))
        drawn = Image.open(io.BytesIO(picture(figure, "png", 200))).convert("RGB")
    written = small(drawn, figure)
    assert written.mode == "P"
    bar = next(axis for axis in figure.axes if axis.get_label() == "<colorbar>").get_window_extent()
    column, rows = (
        round(0.5 * (bar.x0 + bar.x1)),
        slice(round(drawn.height - bar.y1) + 3, round(drawn.height - bar.y0) - 3),
    )
    before, after = (np.asarray(image.convert("RGB"), dtype=int)[rows, column] for image in (drawn, written))
    assert len(before) > 100
    assert np.max(np.abs(after - before)) <= 6  # as far apart as neighbours among the bar's 216 colours


@pytest.mark.parametrize(
    "name", [name for name in installed_scenes.installed() if not name.startswith(("one-", "two-", "three-"))]
)
def test_every_scene_of_an_ingredient_stands_in_the_gallery(name):
    assert f"`{name}`" in GALLERY
