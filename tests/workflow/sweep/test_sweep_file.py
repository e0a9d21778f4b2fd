"""What a sweep file means: its cases, their scenes and names; and what is wrong with it in one line."""

from pathlib import Path

import numpy as np
import pytest
from sweeps import SMALL

from workflow.sweep.file import SpacedValues, all_cases, case_name, from_plain, scene_of


def cases(**options):
    return all_cases(from_plain({"scene": SMALL, **options}, Path("s.yaml")))


def test_a_product_has_every_combination_and_each_is_the_scene_with_those_values():
    what = from_plain({"scene": SMALL, "vary": {"kick.velocity": [1.0, 2.0], "coupling.stiffness": [0.1, 0.2]}}, Path())
    found = {
        (scene_of(what, case).kick[0].velocity, scene_of(what, case).coupling.stiffness) for case in all_cases(what)
    }
    assert found == {(1.0, 0.1), (1.0, 0.2), (2.0, 0.1), (2.0, 0.2)}


def test_zip_takes_first_with_first():
    found = cases(vary={"beads": [12, 14], "duration": [10, 12]}, combine="zip")
    assert [case.values for case in found] == [{"beads": 12, "duration": 10}, {"beads": 14, "duration": 12}]


def test_a_part_that_the_scene_does_not_name_is_made_and_one_kick_of_two_is_named_by_its_number():
    plain = {**SMALL, "coupling": None, "kick": [{"velocity": 1.0}, {"bead": 5, "velocity": 0.5}]}
    scene = {key: value for key, value in plain.items() if value is not None}
    what = from_plain({"scene": scene, "vary": {"coupling.stiffness": [0.3], "kick[2].velocity": [0.25]}}, Path())
    (case,) = all_cases(what)
    assert scene_of(what, case).coupling.stiffness == 0.3
    assert [kick.velocity for kick in scene_of(what, case).kick] == [1.0, 0.25]
    assert case.name == "coupling.stiffness=0.3,kick2.velocity=0.25"


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


def test_names_have_an_order_of_their_own_and_as_many_digits_as_tell_values_apart():
    (case,) = cases(vary={"kick.velocity": [0.1], "coupling.stiffness": [0.05]})
    assert case.name == "coupling.stiffness=0.05,kick.velocity=0.1"
    ratio = {"from": 0.02, "to": 0.5, "count": 3, "spacing": "log"}
    found = [case.name for case in cases(vary={"coupling.stiffness": ratio})]
    assert found == [f"coupling.stiffness={number}" for number in ("0.02", "0.1", "0.5")]
    close = cases(vary={"kick.velocity": [1 / 3, 1, 1.0000004]})
    assert [case.name for case in close] == [f"kick.velocity={number}" for number in ("0.33333333", "1", "1.0000004")]
    assert close[0].values == {"kick.velocity": 1 / 3}


@pytest.mark.parametrize("value", ["../../etc", "$(ls) b", "x" * 500, ["a", {"b": 1}], "\x1b[31m", ""])
def test_whatever_the_value_a_name_is_one_safe_word(value):
    word = case_name({"description": value}).removeprefix("description=")
    assert 0 < len(word) <= 40
    assert all(letter.isascii() and (letter.isalnum() or letter in "._-") for letter in word)
    assert word.strip(".")
