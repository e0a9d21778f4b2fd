"""The JSON schema of scenes accepts what the program reads, and refuses plain mistakes."""

import json
from pathlib import Path

import jsonschema
import pytest

import lammps_inputs
from lammps_inputs import installed_scenes, library, schema

FILE = Path(lammps_inputs.__file__).parent / library.SCHEMA
VALIDATOR = jsonschema.Draft202012Validator(schema.scene())


def complaints(text, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    return [error.json_path for error in VALIDATOR.iter_errors(library.load_plain(path))]


def test_the_file_that_scenes_name_is_the_schema_of_today():
    assert json.loads(FILE.read_text()) == schema.scene(), (
        "granchain schema > lammps_inputs/templates/scene.schema.json"
    )


@pytest.mark.parametrize("name", installed_scenes.installed())
def test_an_installed_scene_names_the_schema_and_fits_it(name):
    path = installed_scenes.installed()[name]
    first = path.read_text().splitlines()[0]
    assert (path.parent / first.removeprefix(library.EDITORS)).resolve() == FILE
    assert list(VALIDATOR.iter_errors(library.load_plain(path))) == []


@pytest.mark.parametrize(
    ("line", "where"),
    [
        ("bead: 3", "$"),
        ("beads: 1", "$.beads"),
        ("coupling: {stifness: 1}", "$.coupling"),
        ("kick: {velocity: fast}", "$.kick"),
    ],
)
def test_a_mistake_is_found_where_it_stands(line, where, tmp_path):
    right = {"beads": "beads: 9", "kick": "kick: {velocity: 1}", "duration": "duration: 2", "name": "name: a"}
    right[line.partition(":")[0]] = line
    assert complaints("\n".join(right.values()), tmp_path) == [where]
