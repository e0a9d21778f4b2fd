"""README and gallery show what there is."""

import re
from pathlib import Path

import pytest
from gallery import FOLDER, PICTURES

from lammps_inputs import installed_scenes

PAGES = ("README.md", "lammps_inputs/GALLERY.md", "lammps_inputs/SCENES.md", "analysis/README.md")
README, GALLERY, *REFERENCES = ((Path(__file__).parents[1] / page).read_text(encoding="utf-8") for page in PAGES)
SHOWN = set(re.findall(r"\]\([./]*\.github/([\w/-]+)\.png\)", "".join((README, GALLERY, *REFERENCES))))
OTHERS = {"trade", "view"}  # of one machine's speed, and of a page in a browser


def test_every_picture_is_drawn_by_the_script_and_small():
    assert set(PICTURES) == SHOWN - OTHERS
    assert all((FOLDER / f"{name}.png").stat().st_size < 60_000 for name in PICTURES)


@pytest.mark.parametrize(
    "name", [name for name in installed_scenes.installed() if not name.startswith(("one-", "two-", "three-"))]
)
def test_every_scene_of_an_ingredient_stands_in_the_gallery(name):
    assert f"`{name}`" in GALLERY
