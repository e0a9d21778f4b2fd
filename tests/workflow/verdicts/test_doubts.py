"""What is named as a cause lies beyond its uncertainty, and the true number within it; and doubts about references."""

from dataclasses import replace

import numpy as np
import pytest
from wrong_runs import causes

from analysis.compare.identify import identify
from lammps_inputs import library
from lammps_inputs.laws.in_time import half_sine
from workflow.engines.reference import engine

PLAIN = {"name": "test", "chains": 2, "beads": 8, "kick": {"velocity": 1.0}, "duration": 12.0, "output": {"every": 0.1}}

SPRINGS, GROUND = {"coupling": {"stiffness": 0.1}}, {"foundation": {"stiffness": 0.5}}

PUSH = {"push": {"chain": 2, "bead": 3, "peak": 1.0, "duration": 1.0, "shape": "half-sine"}}

WALL = {"walls": {"right": {"stiffness": 1.0}}}


def problem(keys):
    return library.from_plain({**PLAIN, **keys}, "test").problem()


def stronger(name, parameter, where=True):
    """A function of a system and a factor: the system in which the links of a name are as many times as strong."""

    def changed(link, factor):
        if link.name != name:
            return link
        value = getattr(link.law, parameter) * np.where(where, factor, 1.0)
        return replace(link, law=replace(link.law, **{parameter: value}))

    return lambda system, factor: replace(system, links=tuple(changed(link, factor) for link in system.links))


CHAINS, NUMBER = np.ogrid[:2, :8]
FIFTH = (CHAINS == 0) & (NUMBER == 4)

stiffer_springs, stiffer_ground = stronger("coupling", "spring"), stronger("foundation", "spring")
stiffer_wall, stronger_contact = stronger("right_wall", "strength"), stronger("contacts", "strength", FIFTH[:, :7])


def heavier_bead(system, factor):
    return replace(system, mass=np.where(FIFTH, factor, 1.0))


def stronger_push(system, factor):
    (load,) = system.loads
    return replace(system, loads=(replace(load, law=replace(load.law, peak=factor * load.law.peak)),))


def longer_push(system, factor):
    (load,) = system.loads
    return replace(system, loads=(replace(load, law=half_sine(load.law.peak, factor * load.law.duration)),))


def pair(right, *changes):
    """Trajectory of a problem whose system was changed, and that of the problem itself."""
    system = right.system
    for change, factor in changes:
        system = change(system, factor)
    return replace(engine.run(replace(right, system=system)), problem=right), engine.run(right)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("keys", "change", "name"),
    [
        (SPRINGS, stiffer_springs, "coupling"),
        (GROUND, stiffer_ground, "foundation"),
        (WALL, stiffer_wall, "right_wall"),
        ({}, heavier_bead, "bead"),
        ({}, stronger_contact, "contacts"),
        (PUSH, stronger_push, "push on bead 3 of chain 2"),
    ],
    ids=["springs", "ground", "wall", "mass", "contact", "push"],
)
@pytest.mark.parametrize("factor", [0.8, 1.01])
def test_a_departure_from_the_scene_is_known_within_its_uncertainty(keys, change, name, factor):
    (departure,) = identify(*pair(problem(keys), (change, factor))).departures
    assert departure.name == name
    assert abs(departure.factor - factor) <= departure.uncertainty < 0.01


@pytest.mark.parametrize(
    ("keys", "change"),
    [(SPRINGS, stiffer_springs), ({}, heavier_bead), (PUSH, stronger_push)],
    ids=["springs", "mass", "push"],
)
def test_a_departure_within_what_the_interpolation_leaves_is_not_named(keys, change):
    found = identify(*pair(problem(keys), (change, 1.0 + 1e-7)))
    assert found.departures == ()
    assert found.unexplained < 3.0 * found.interpolation


@pytest.mark.slow
def test_all_that_departs_from_the_scene_is_named_largest_effect_first():
    right = problem({**GROUND, **SPRINGS})
    said = causes(*pair(right, (stiffer_springs, 1.02), (stiffer_ground, 1.5)))
    assert said == [
        "the foundation is 1.5 times as strong as the scene says",
        "the coupling is 1.02 times as strong as the scene says",
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "factor", "said"),
    [(stronger_push, 0.0, "is missing"), (longer_push, 1.1, "is 1.1 times that of the scene")],
)
def test_a_push_that_is_missing_or_lasts_longer_is_named(change, factor, said):
    (cause,) = causes(*pair(problem(PUSH), (change, factor)))
    assert "push on bead 3 of chain 2" in cause
    assert cause.endswith(said)
