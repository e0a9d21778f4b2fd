import sys

import numpy as np
import pytest
from bad_scenes import assert_one_line
from hypothesis import given
from hypothesis import strategies as st
from strategies import VALUES

from lammps_inputs import (
    InputError,
    Scene,
    complaints,
    find,
    library,
    physics,
    references,
    strict_yaml,
)
from lammps_inputs.ingredients import registry


def parts(model):
    """A model of a scene and all that it holds."""
    inner = (part for field in model.model_fields.values() for part in complaints.models_in(field.annotation))
    return {model, *(found for part in inner for found in parts(part))}


@pytest.mark.parametrize("part", sorted(filter(lambda part: part.example, parts(Scene)), key=str))
def test_the_example_of_a_part_is_valid(part):
    part.model_validate(strict_yaml.parse(f"example: {part.example}", "here")["example"])


def scene_or_one_line(data):
    try:
        scene = library.from_plain(data, "here")
    except InputError as error:
        assert_one_line(error, "here: ")
    else:
        assert isinstance(scene, Scene)


KEYS = st.text(max_size=12) | st.sampled_from(list(Scene.model_fields))
PARTS = st.sampled_from(["kick", "coupling", "material", "output"])
INNER = st.sampled_from(["chain", "bead", "velocity", "model", "stiffness", "radius", "density", "every", "beads", "x"])


@pytest.mark.slow
@given(st.tuples(KEYS, VALUES) | st.tuples(PARTS, st.dictionaries(INNER, VALUES, min_size=1, max_size=1)))
def test_any_value_of_any_key_gives_a_scene_or_one_line(pair):
    scene_or_one_line({"name": "a", "beads": 9, "kick": {"velocity": 1.0}, "duration": 5.0, **dict([pair])})


@given(st.lists(st.floats(0.0, 1e30, exclude_min=True), min_size=7, max_size=7))
def test_any_positive_numbers_give_a_scene_or_one_line(numbers):
    radius, density, modulus, velocity, duration, every, stiffness = numbers
    material = {"radius": radius, "density": density, "youngs_modulus": modulus, "poisson_ratio": 0.3}
    kicked = {"kick": {"velocity": velocity}, "coupling": {"stiffness": stiffness}}
    times = {"duration": duration, "output": {"every": every}}
    scene_or_one_line({"name": "a", "beads": 9, "chains": 2, "material": material, **kicked, **times})


@pytest.mark.parametrize(
    ("name", "chains", "kappa"), [("two-chains", 2, 0.1), ("two-chains-strong", 2, 0.5), ("three-chains", 3, 0.1)]
)
def test_the_scenes_of_the_figures_have_the_numbers_of_the_paper(name, chains, kappa):
    scene = find(name)
    assert (scene.chains, physics.kappa(scene.system), scene.kick[0].velocity) == (chains, kappa, 1.0)
    assert scene.beads >= 120


def test_the_steel_scene_is_the_two_chain_scene_in_si():
    steel, reduced = find("two-chains-steel"), find("two-chains")
    assert steel.scale.si
    assert physics.kappa(steel.system) == pytest.approx(
        physics.kappa(reduced.system), rel=2e-3
    )  # 2.41e6 N/m has three digits
    assert steel.problem().duration == pytest.approx(192, rel=0.03)


def test_a_material_by_name_is_one_with_its_constants_but_for_those_given():
    scene = {"name": "a", "beads": 9, "kick": {"velocity": 1.0}, "duration": 1e-4, "pattern": ["other"]}
    named = scene | {
        "material": {"name": "steel", "radius": 1e-3, "density": 7e3},
        "kinds": {"other": {"material": "ptfe"}},
    }
    steel = {"radius": 1e-3, "density": 7e3, "youngs_modulus": 193e9, "poisson_ratio": 0.3}
    ptfe = {"density": 2178.0, "youngs_modulus": 1.46e9, "poisson_ratio": 0.46}
    found, same = (
        library.from_plain(named, ""),
        library.from_plain(scene | {"material": steel, "kinds": {"other": ptfe}}, ""),
    )
    assert np.array_equal(found.system.mass, same.system.mass)
    assert (found.scale, found.system.along) == (same.scale, same.system.along)
    assert library.from_plain(found.plain(), "") == found
    assert references.of_scene(found)["material"] == ["daraio2005", "daraio2006"]


@pytest.mark.parametrize(
    ("source", "says"),
    [
        (None, "ModuleNotFoundError"),
        ("def f(:", "SyntaxError"),
        ("INGREDIENTS = {'bed': 3}", "should hold keys of a scene"),
    ],
)
def test_own_ingredients_that_are_none_are_refused_by_the_name_of_their_module(source, says, tmp_path, monkeypatch):
    if source is not None:
        (tmp_path / "bed_of_mine.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "bed_of_mine", raising=False)
    with pytest.raises(InputError, match="GRANCHAIN_INGREDIENTS: ") as caught:
        registry._of_module("bed_of_mine")
    assert says in str(caught.value)
    assert "'bed_of_mine'" in str(caught.value)
