"""README and gallery show what there is."""

import re
from pathlib import Path

from gallery import FOLDER, PICTURES

PAGES = ("README.md", "lammps_inputs/GALLERY.md", "lammps_inputs/SCENES.md", "analysis/README.md")
README, GALLERY, *REFERENCES = ((Path(__file__).parents[1] / page).read_text(encoding="utf-8") for page in PAGES)
SHOWN = set(re.findall(r"\]\([./]*\.github/([\w/-]+)\.png\)", "".join((README, GALLERY, *REFERENCES))))
OTHERS = {"trade", "view"}  # of one machine's speed, and of a page in a browser


def test_every_picture_is_drawn_by_the_script_and_small():
    assert set(PICTURES) == SHOWN - OTHERS
    assert all((FOLDER / f"{name}.png").stat().st_size < 60_000 for name in PICTURES)
