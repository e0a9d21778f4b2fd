"""What `granchain help` prints is what the folder's README says."""

import pytest

from lammps_inputs import handbook
from lammps_inputs.ingredients import INGREDIENTS
from lammps_inputs.scene import BaseScene, Scene


def test_every_key_of_a_scene_has_an_entry():
    assert set(Scene.model_fields) - set(handbook.keys()) == set()


@pytest.mark.parametrize("key", ["coupling", "coupling.rows", "coupling.stiffness.from"])
def test_a_key_within_another_is_explained_there(key):
    assert "springs between the beads of a row" in handbook.of_key(key)


def test_a_default_is_told():
    assert handbook.of_key("gap").endswith("(default: they touch)")


@pytest.mark.parametrize("word", ["no_such", "", "a b", "gap`", ".", "[1]"])
def test_what_is_no_key_has_no_entry(word):
    assert handbook.of_key(word) is None


def test_the_whole_part_holds_every_entry_without_markdown():
    whole = handbook.scenes()
    assert "`" not in whole
    assert all(handbook.of_key(key) in whole for key in (*BaseScene.model_fields, *INGREDIENTS))
