"""What a sweep file means: its cases, their scenes and names; and what is wrong with it in one line."""

from pathlib import Path

import numpy as np
import pytest
from sweeps import SMALL

from workflow.sweep.file import SpacedValues, all_cases, case_name, from_plain, scene_of


def cases(**options):
    return all_cases(from_plain({"scene": SMALL, **options}, Path("s.yaml")))


# --- what a sweep file means ------------------------------------------------------------------------------------------


def test_a_product_has_every_combination_and_each_is_the_scene_with_those_values():
    what = from_plain({"scene": SMALL, "vary": {"kick.velocity": [1.0, 2.0], "coupling.stiffness": [0.1, 0.2]}}, Path())
    found = {
        (scene_of(what, case).kick[0].velocity, scene_of(what, case).coupling.stiffness) for case in all_cases(what)
    }
    assert found == {(1.0, 0.1), (1.0, 0.2), (2.0, 0.1), (2.0, 0.2)}


def test_zip_takes_first_with_first():
    found = cases(vary={"beads": [12, 14], "duration": [10, 12]}, combine="zip")
    assert [case.values for case in found] == [{"beads": 12, "duration": 10}, {"beads": 14, "duration": 12}]


def test_a_part_that_the_scene_does_not_name_is_made():
    plain = {key: value for key, value in SMALL.items() if key not in ("coupling", "kick")}
    what = from_plain({"scene": plain, "vary": {"coupling.stiffness": [0.3], "kick.velocity": [2.0]}}, Path())
    scene = scene_of(what, all_cases(what)[0])
    assert (scene.coupling.stiffness, scene.kick[0].velocity) == (0.3, 2.0)


def test_one_kick_of_two_is_named_by_its_number():
    two = {**SMALL, "kick": [{"velocity": 1.0}, {"bead": 5, "velocity": 0.5}]}
    what = from_plain({"scene": two, "vary": {"kick[2].velocity": [0.25]}}, Path())
    (case,) = all_cases(what)
    assert [kick.velocity for kick in scene_of(what, case).kick] == [1.0, 0.25]
    assert case.name == "kick2.velocity=0.25"


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ({"from": 0.1, "to": 0.4, "count": 4}, [0.1, 0.2, 0.3, 0.4]),
        ({"from": 0.1, "to": 10, "count": 3, "spacing": "log"}, [0.1, 1.0, 10]),
        ({"from": 2, "to": 8, "count": 4}, [2, 4, 6, 8]),
        ({"from": 10, "to": 1000, "count": 5, "spacing": "log", "digits": 2}, [10, 32, 100, 320, 1000]),
        ({"from": 1, "to": -1, "count": 3}, [1, 0, -1]),
        ({"from": 2, "to": 5}, [2, 3, 4, 5]),
        ({"from": 1, "to": -1}, [1, 0, -1]),
    ],
)
def test_a_range_has_the_numbers_one_would_write(given, values):
    found = SpacedValues.model_validate(given).values()
    assert found == values
    assert [type(value) for value in found] == [type(value) for value in values]


def test_a_logarithmic_range_has_equal_ratios():
    found = SpacedValues.model_validate({"from": 0.1, "to": 10, "count": 6, "spacing": "log"}).values()
    np.testing.assert_allclose(np.diff(np.log(found)), np.log(100.0) / 5, rtol=1e-13)


# --- names ------------------------------------------------------------------------------------------------------------


def test_names_say_field_and_value_in_an_order_that_does_not_depend_on_the_file():
    one = cases(vary={"kick.velocity": [0.1], "coupling.stiffness": [0.05]})
    other = cases(vary={"coupling.stiffness": [0.05], "kick.velocity": [0.1]})
    assert one[0].name == other[0].name == "coupling.stiffness=0.05,kick.velocity=0.1"


def test_numbers_in_the_names_of_a_sweep_have_as_many_digits_as_tell_its_values_apart():
    ratio = {"from": 0.02, "to": 0.5, "count": 3, "spacing": "log"}
    assert [case.name for case in cases(vary={"coupling.stiffness": ratio})] == [
        "coupling.stiffness=0.02",
        "coupling.stiffness=0.1",
        "coupling.stiffness=0.5",
    ]
    close = cases(vary={"kick.velocity": [1 / 3, 1, 1.0000004]})
    assert [case.name for case in close] == [f"kick.velocity={number}" for number in ("0.33333333", "1", "1.0000004")]
    assert close[0].values == {"kick.velocity": 1 / 3}


@pytest.mark.parametrize(
    "value", ["../../etc", "a/b", "$(ls)", "a b", "x" * 500, ["a", {"b": 1}], "\x1b[31m", "..", ""]
)
def test_whatever_the_value_a_name_is_one_safe_word(value):
    word = case_name({"description": value}).removeprefix("description=")
    assert 0 < len(word) <= 40
    assert all(letter.isascii() and (letter.isalnum() or letter in "._-") for letter in word)
    assert word.strip(".")
