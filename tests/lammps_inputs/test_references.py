"""Pages of the manual hold the tables of the types and the bibliography, and what a scene cites is in that."""

from pathlib import Path

import key_tables
import pytest

import lammps_inputs
from lammps_inputs import installed_scenes, library, references
from lammps_inputs.scene import BaseScene


@pytest.mark.parametrize("name", key_tables.PAGES)
def test_tables_of_keys_are_those_of_the_types_and_references_those_of_the_bibliography(name):
    page = (Path(lammps_inputs.__file__).parent / name).read_text(encoding="utf-8")
    assert key_tables.renewed(page) == page, "run `python tests/support/key_tables.py`"


def test_every_key_has_a_meaning():
    for name in (*key_tables.PARTS, " ".join(BaseScene.model_fields)):
        assert all(row.split(" | ")[-1].strip(" |") for row in key_tables.table(name).splitlines()), name


def test_what_installed_scenes_cite_is_in_the_bibliography():
    for name in installed_scenes.installed():
        cited = references.of_scene(library.find(name))
        assert {key for keys in cited.values() for key in keys} <= set(references.bibtex()), name
