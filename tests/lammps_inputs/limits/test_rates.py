"""How fast anything can move, by hand."""

import math
from typing import Any

import pytest

from lammps_inputs import System, library
from lammps_inputs.limits import rates

TIED = {"chains": 2, "coupling": {"stiffness": 0.1}}

LIGHT = {"kinds": {"light": {"mass": 0.25}}, "replace": {"bead": 3, "kind": "light"}}


def system(**keys: Any) -> System:
    plain = {"name": "test", "beads": 6, "kick": {"velocity": 1.0}, "duration": 10.0}
    return library.from_plain({**plain, **keys}, "test").system


@pytest.mark.parametrize(
    ("keys", "square"),
    [
        ({}, 4.0),  # in units of k = 3/2 F0^(1/3)
        ({"walls": {"right": {"stiffness": 100.0}}}, 2.0 + 100.0 ** (2.0 / 3.0)),  # k of a contact is as A^(2/3)
        (LIGHT, 4.0 / 0.25),
    ],
)
def test_sound_is_bounded_by_contacts_and_walls_on_either_side_of_a_bead(keys: dict[str, Any], square: float) -> None:
    loaded = system(precompression={"force": 8.0}, **keys)
    assert rates.sound_frequency(loaded) ** 2 == pytest.approx(square * 3.0, rel=1e-9)


def test_a_swing_is_that_of_springs_and_sound_together() -> None:
    assert rates.modal_frequency(system(**TIED)) ** 2 == pytest.approx(2.0 * 0.1)
    held = {**TIED, "foundation": {"stiffness": 0.5}}
    assert rates.modal_frequency(system(**held)) ** 2 == pytest.approx(2.0 * 0.1 + 0.5)
    assert rates.modal_frequency(system(**held, precompression={"force": 8.0})) ** 2 == pytest.approx(0.7 + 12.0)


@pytest.mark.parametrize(
    ("damping", "keys", "rate"),
    [
        ({"beads": 0.3}, {}, 0.3),
        ({"beads": 0.3}, LIGHT, 0.3 / 0.25),
        ({"coupling": 0.3}, TIED, 2.0 * 0.3),
        ({"beads": 0.1, "coupling": 0.3}, TIED, 0.1 + 2.0 * 0.3),
        ({"contact": 0.3}, {}, 4.0 * 0.3),
        ({"contact": 0.3}, LIGHT, 4.0 * 0.3 / 0.25),
    ],
)
def test_drag_is_that_of_the_lightest_bead_against_all_beside_it(
    damping: dict[str, Any], keys: dict[str, Any], rate: float
) -> None:
    assert rates.drag(system(damping=damping, **keys)) == pytest.approx(rate)


def test_nothing_is_faster_than_a_drive() -> None:
    """At V = 1 the unit of time is V**-0.2."""
    turn = 2.0 * math.pi * 100.0
    driven = system(kick=None, drive={"displacement": 0.1, "frequency": 100.0})
    assert rates.fastest(driven) == pytest.approx(turn * (0.1 * turn) ** -0.2)
