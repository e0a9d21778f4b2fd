"""The README shows what there is."""

import re
from pathlib import Path

import pytest
from gallery import FOLDER, PICTURES

from lammps_inputs import shipped

README, SCENES = (
    (Path(__file__).parents[1] / page).read_text(encoding="utf-8") for page in ("README.md", "lammps_inputs/SCENES.md")
)
SHOWN = set(re.findall(r"\]\([./]*\.github/([\w/-]+)\.png\)", README + SCENES))
OTHERS = {"trade", "view"}  # of one machine's speed, and of a page in a browser


def test_every_picture_is_drawn_by_the_script_and_small():
    assert set(PICTURES) == SHOWN - OTHERS
    assert all((FOLDER / f"{name}.png").stat().st_size < (60_000 if "/" in name else 80_000) for name in PICTURES)


@pytest.mark.parametrize(
    "name", [name for name in shipped.installed() if not name.startswith(("one-", "two-", "three-"))]
)
def test_every_scene_of_an_ingredient_stands_in_the_gallery(name):
    assert f"`{name}`" in README
