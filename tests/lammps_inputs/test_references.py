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


@pytest.mark.parametrize("name", [*key_tables.PARTS, " ".join(BaseScene.model_fields)])
def test_every_key_has_a_meaning(name):
    assert all(row.split(" | ")[-1].strip(" |") for row in key_tables.table(name).splitlines())


@pytest.mark.parametrize("name", installed_scenes.installed())
def test_what_a_scene_cites_is_in_the_bibliography(name):
    cited = references.of_scene(library.find(name))
    assert {key for keys in cited.values() for key in keys} <= set(references.bibtex())


def test_a_damped_scene_cites_the_source_of_its_law():
    assert references.of_scene(library.find("restitution"))["damping"] == ["tsuji1992", "antypov2011"]
    assert references.text("antypov2011").endswith("EPL 94, 50004 (2011), doi:10.1209/0295-5075/94/50004")
