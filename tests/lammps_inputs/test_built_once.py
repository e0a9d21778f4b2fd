"""A scene's setting, system and problem are built once, and a changed scene has its own."""

import pickle
from collections import Counter
from dataclasses import fields

import pytest

import lammps_inputs.scene
from lammps_inputs import Scene, library
from lammps_inputs.decks import scene_files
from lammps_inputs.ingredients.base import Setting

TWO = Scene(name="two", chains=2, beads=6, kick={"velocity": 1.0}, coupling={"stiffness": 0.1}, duration=4.0)


@pytest.mark.parametrize("name", ["lattice-of-nine", "precompressed"])
def test_loading_a_scene_and_writing_its_deck_builds_one_system_and_one_problem(name, monkeypatch):
    built = Counter()
    for kind in ("System", "Problem"):
        monkeypatch.setattr(lammps_inputs.scene, kind, _counted(kind, getattr(lammps_inputs.scene, kind), built))
    scene = library.find(name).resolved()
    scene = scene.model_copy(update={"timestep": 0.5 * scene.output.every / 10, "duration": scene.output.every * 8})
    assert "V = " in scene.units
    assert scene.unlikely == []
    assert scene.problem() is scene.problem()
    scene_files.render(scene)
    assert built == {"System": 1, "Problem": 1}


def _counted(name, kind, built):
    def make(**parts):
        built[name] += 1
        return kind(**parts)

    return make


CHANGES = {
    "chains": 3,
    "beads": 7,
    "gap": 0.5,
    "kick": lambda: Scene(name="a", beads=2, kick={"velocity": -2.0, "bead": 2}, duration=1.0).kick,
    "taper": 0.1,
    "coupling": None,
    "foundation": lambda: _part("foundation", {"stiffness": 0.3}),
    "walls": lambda: _part("walls", {"right": "rigid"}),
    "damping": lambda: _part("damping", {"contact": 0.1}),
    "contact": lambda: _part("contact", {"exponent": 2.0}),
    "precompression": lambda: _part("precompression", {"force": 0.1}),
    "duration": 9.0,
    "timestep": 0.05,
    "scheme": "suzuki4",
}


def _part(key, keys):
    return Scene.model_validate({**TWO.plain(), "walls": {"left": "bead", "right": "bead"}, key: keys}).part(key)


@pytest.mark.parametrize("key", CHANGES)
def test_a_copy_with_another_value_has_the_problem_of_a_scene_that_was_loaded_with_it(key):
    value = CHANGES[key]() if callable(CHANGES[key]) else CHANGES[key]
    assert TWO.problem().system is TWO.system
    changed = TWO.model_copy(update={key: value})
    loaded = Scene.model_validate(changed.plain())
    assert changed == loaded
    assert changed.system == loaded.system
    assert changed.problem() == loaded.problem() != TWO.problem()


def test_a_copy_has_the_system_of_the_scene_only_where_the_changed_key_is_none_that_ingredients_see():
    seen = {*TWO.setting.parts, *(field.name for field in fields(Setting))}
    same = {key for key in Scene.model_fields if _copied(key).system is TWO.system}
    assert same & seen == set()
    assert {"duration", "timestep", "output"} <= same


def _copied(key):
    return TWO.model_copy(update={key: getattr(TWO, key)})


def test_what_was_built_of_a_scene_neither_changes_it_nor_is_stored_with_it():
    scene = Scene.model_validate(TWO.plain())
    problem, stored = scene.problem(), pickle.dumps(scene)
    assert problem.system is scene.system
    assert scene == Scene.model_validate(TWO.plain())
    assert b"Hertz" not in stored
    assert Scene(**dict(scene)) == scene
    assert pickle.loads(stored) == scene
    assert pickle.loads(stored).problem() == problem
