"""Warnings of values that are valid and probably not meant: springs without effect, times of another unit."""

import numpy as np
import pytest

from lammps_inputs import library
from lammps_inputs.scene import EQUAL_BEADS, UNCOUPLED
from workflow.engines.reference import engine

PAIR = {"name": "a", "chains": 2, "beads": 40, "coupling": {"stiffness": 0.1}, "kick": {"velocity": 1}, "duration": 60}
BALL = {"name": "steel", "radius": 4.76e-3}
LEAST = UNCOUPLED * EQUAL_BEADS / 60
"""kappa from which chains count as coupled over 60 T."""


def warnings(**changes):
    plain = {key: value for key, value in {**PAIR, **changes}.items() if value is not None}
    return library.from_plain(plain, "a").unlikely


@pytest.mark.parametrize(
    ("changes", "kappa", "beads"),
    [
        ({"material": BALL, "duration": 480e-6}, "4.14e-09", "1.2e+09"),
        ({"material": BALL, "until_bead": 40, "duration": None}, "4.14e-09", "1.2e+09"),
        ({"coupling": {"stiffness": 0.99 * LEAST}}, "8.25e-05", "6.1e+04"),
        ({"coupling": {"stiffness": 1e-8}, "gap": 10.0}, "1e-08", "5e+06"),
    ],
)
def test_springs_without_effect_are_named_with_kappa_and_the_beads_that_they_need(changes, kappa, beads):
    (warning,) = warnings(**changes)
    assert warning.startswith(f"coupling.stiffness: kappa = {kappa}, so the chains are practically uncoupled")
    assert f"after some {beads} beads, and a chain has 40" in warning


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"coupling": {"stiffness": 1.01 * LEAST}},
        {"coupling": {"stiffness": 1e-6}, "gap": 20.0},
        {"material": BALL, "duration": 480e-6, "coupling": {"stiffness": 2.4e6}},
        {"coupling": {"stiffness": 0.0}},
        {"coupling": None},
    ],
    ids=str,
)
def test_others_are_not(changes):
    assert warnings(**changes) == []


def test_where_springs_count_as_without_effect_neighbours_move_with_about_a_hundredth_of_v_at_most():
    plain = {**PAIR, "coupling": {"stiffness": LEAST}}
    fastest = np.abs(engine.run(library.from_plain(plain, "a").problem()).velocity[:, 1]).max()
    assert 1e-3 < fastest < 0.012


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"duration": 480e-6}, "duration"),
        ({"duration": 1.0, "timestep": 1e-7, "output": {"every": 0.1}}, "timestep"),
        ({"until_bead": 3, "duration": None, "output": {"every": 1e-6}}, "output.every"),
        ({"kick": {"velocity": 0.443}, "duration": 480e-6}, "duration"),
    ],
)
def test_times_as_short_as_in_seconds_ask_for_a_material(changes, key):
    (warning,) = (line for line in warnings(**changes) if line.startswith(f"{key} in s? "))
    assert "a scene in SI units needs a `material`" in warning
