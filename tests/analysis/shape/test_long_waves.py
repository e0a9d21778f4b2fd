"""Cells that repeat along chains, and how long pulses are in them."""

import math

import numpy as np
import pytest
from synthetic_waves import of_keys

from analysis.shape.long_waves import length_of, period_of, repeats_between, sound_speed
from lammps_inputs import physics

KINDS = {"kinds": {"a": {"mass": 1.0}, "b": {"mass": 0.3428}, "c": {"mass": 4.0}}}


def problem(**more):
    plain = {"beads": 40, "kick": {"velocity": 1.0}, "duration": 10.0}
    return of_keys(**{**plain, **more})


CASES = {
    "alike": ({}, 1),
    "one bead": ({**KINDS, "replace": {"bead": 20, "kind": "c"}}, 1),
    "dimer": ({**KINDS, "pattern": ["a", "b"]}, 2),
    "dimer and one bead": ({**KINDS, "pattern": ["a", "b"], "replace": {"bead": 20, "kind": "c"}}, 2),
    "four": ({**KINDS, "pattern": ["a", "b", "b", "a"]}, 4),
    "of two chains": ({**KINDS, "chains": 2, "pattern": [["a", "b"], ["a", "a", "b"]]}, 6),
    "taper": ({"taper": 0.01}, 1),
    "disorder": ({"disorder": {"mass": 0.1, "seed": 1}}, 1),
}


@pytest.mark.parametrize("name", CASES)
def test_a_cell_is_what_repeats_but_for_single_beads(name):
    more, beads = CASES[name]
    assert period_of(problem(**more).system) == beads


@pytest.mark.parametrize(("first", "last", "alike"), [(2, 18, True), (2, 19, False), (21, 40, True), (10, 30, False)])
def test_beads_repeat_up_to_the_contact_of_one_of_another_kind(first, last, alike):
    """The contacts of bead 20, of another radius, differ too: that with bead 19 counts as the latter's."""
    odd = problem(kinds={"odd": {"radius": 2.0}}, replace={"bead": 20, "kind": "odd"})
    assert repeats_between(odd.system, 0, first, last, 1) == alike


@pytest.mark.parametrize("mass", [0.1548, 0.3428, 3.0])
def test_pulses_of_dimers_are_longer_by_the_dispersion_of_long_waves(mass):
    """beta = (1 - 3 mu) / 3 in beads, with mu = m1 m2 / (m1 + m2)**2."""
    dimer = problem(kinds={"a": {"mass": 1.0}, "b": {"mass": mass}}, pattern=["a", "b"])
    assert length_of(dimer.system) == pytest.approx(2.0 * math.sqrt(1.0 - 3.0 * mass / (1.0 + mass) ** 2), rel=1e-3)
    assert length_of(problem().system) == 1.0


def test_the_speed_of_sound_at_a_bead_is_of_the_means_that_its_definition_states():
    """Stiffness k = 1.5 A^(2/3) F^(1/3) of each contact under a load F = 0.3."""
    strength = 1.0 + 0.3 * np.sin(np.arange(39.0))
    system = problem(precompression={"force": 0.3}, contact={"strength": strength.tolist()}, taper=0.01).system
    mass = np.asarray(physics.mass_with_tied(system))[0]
    radius = np.cbrt(mass)
    contacts = strength * np.sqrt(2.0 * radius[1:] * radius[:-1] / (radius[1:] + radius[:-1]))
    stiffness = 1.5 * contacts ** (2.0 / 3.0) * 0.3 ** (1.0 / 3.0)
    for bead in (10, 20, 30):
        m = np.average(mass[bead - 3 : bead + 2], weights=[1, 2, 2, 2, 1])
        s = np.average(1.0 / stiffness[bead - 4 : bead + 2], weights=[1, 3, 4, 4, 3, 1])
        assert sound_speed(system)[0, bead - 1] == pytest.approx(1.0 / np.sqrt(m * s), rel=1e-9)
