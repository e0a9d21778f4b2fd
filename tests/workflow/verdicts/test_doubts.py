"""What is named as a cause lies beyond its uncertainty, and the true number within it; and doubts about references."""

from dataclasses import replace

import numpy as np
import pytest
from wrong_runs import causes

from analysis.compare.difference import Uncertainty
from analysis.compare.identify import identify
from lammps_inputs import library
from workflow.engines.reference import engine
from workflow.verdicts import validate

PLAIN = {"name": "test", "chains": 2, "beads": 8, "kick": {"velocity": 1.0}, "duration": 12.0, "output": {"every": 0.1}}

SPRINGS, GROUND = {"coupling": {"stiffness": 0.1}}, {"foundation": {"stiffness": 0.5}}

PUSH = {"push": {"chain": 2, "bead": 3, "peak": 1.0, "duration": 1.0, "shape": "half-sine"}}

WALL = {"walls": {"right": {"stiffness": 1.0}}}


def problem(keys):
    return library.from_plain({**PLAIN, **keys}, "test").problem()


def stiffer_springs(system, factor):
    return replace(system, links=tuple(_stronger(link, "spring", factor, "coupling") for link in system.links))


def stiffer_ground(system, factor):
    return replace(system, links=tuple(_stronger(link, "spring", factor, "foundation") for link in system.links))


def stiffer_wall(system, factor):
    return replace(system, links=tuple(_stronger(link, "strength", factor, "right_wall") for link in system.links))


def _stronger(link, parameter, factor, name):
    if link.name != name:
        return link
    return replace(link, law=replace(link.law, **{parameter: factor * getattr(link.law, parameter)}))


def heavier_bead(system, factor):
    mass = np.ones((2, 8))
    mass[0, 4] = factor
    return replace(system, mass=mass)


def stronger_contact(system, factor):
    strength = np.ones((2, 7))
    strength[0, 4] = factor
    return replace(system, links=tuple(_stronger(link, "strength", strength, "contacts") for link in system.links))


def stronger_push(system, factor):
    (load,) = system.loads
    return replace(system, loads=(replace(load, law=replace(load.law, peak=factor * load.law.peak)),))


def pair(right, *changes):
    """Trajectory of a problem whose system was changed, and that of the problem itself."""
    system = right.system
    for change, factor in changes:
        system = change(system, factor)
    return replace(engine.run(replace(right, system=system)), problem=right), engine.run(right)


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


def test_all_that_departs_from_the_scene_is_named_largest_effect_first():
    right = problem({**GROUND, **SPRINGS})
    said = causes(*pair(right, (stiffer_springs, 1.02), (stiffer_ground, 1.5)))
    assert said == [
        "the foundation is 1.5 times as strong as the scene says",
        "the coupling is 1.02 times as strong as the scene says",
    ]


def test_a_heavy_bead_beside_a_weak_contact_is_not_taken_for_many_others():
    right = problem({})
    wrong, reference = pair(right, (heavier_bead, 1.2), (stronger_contact, 0.9))
    assert not any(departure.count > 1 for departure in identify(wrong, reference).departures)


def uncertainty(velocity, arrival):
    return Uncertainty(steps_per_frame=2, velocity=velocity, arrival=arrival, energy=0.0, momentum=0.0)


@pytest.mark.parametrize(("velocity", "arrival", "doubted"), [(5e-4, 2e-3, []), (6e-4, 0.0, ["velocity"])])
def test_a_reference_is_doubted_that_is_less_sure_than_a_tolerance(velocity, arrival, doubted):
    for sure, names in ((uncertainty(velocity, arrival), doubted), (uncertainty(0.0, 2.1e-3), ["arrival"])):
        said = validate._doubts(sure, validate.TOLERANCES)
        assert [line.split(" in ")[1].split(",")[0] for line in said] == names


def test_where_energy_is_exchanged_it_may_miss_what_velocities_may():
    for keys, energy in (({}, 1e-4), ({"damping": {"beads": 0.1}}, 5e-4), (PUSH, 5e-4)):
        problem = library.from_plain({**PLAIN, **keys}, "test").problem()
        assert validate.limits_of(problem, None) == {**validate.TOLERANCES, "energy": energy}
        assert validate.limits_of(problem, {"energy": 1.0})["energy"] == 1.0
