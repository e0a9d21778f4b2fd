"""Trajectories of another law, another time step or other units: what is named as the cause, with its size."""

import re
from dataclasses import replace

import pytest
from plain_scene import scene
from wrong_runs import causes

from analysis.compare.common_times import at_times
from analysis.trajectory import Trajectory
from workflow.engines.reference import engine
from workflow.prepare.pilot import TABLES
from workflow.verdicts.diagnose import diagnose

KEYS = {"beads": 20, "duration": 18.0, "output": {"every": 0.1}}
ONE = {**KEYS, "chains": 1, "coupling": None}
SCENES = {"one chain": ONE, "two chains": KEYS}


@pytest.fixture(scope="module", params=SCENES)
def right(request):
    """Keys of a scene, and its motion."""
    keys = SCENES[request.param]
    return keys, engine.run(scene(**keys).problem())


def other(keys, reference):
    """The motion of other keys, claimed to be that of the reference's scene."""
    return replace(engine.run(scene(**keys).problem()), problem=reference.problem)


def the_number(sentence):
    """The only number of a sentence that has an uncertainty, and that."""
    ((value, bound),) = re.findall(r"(\S+)(?: [A-Z])? \(± ([^)]*)\)", sentence)
    return float(value), float(bound)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1.0, 1.3, 1.4, 1.6, 2.0])
def test_another_exponent_is_named_with_its_difference(right, exponent):
    keys, reference = right
    (cause,) = diagnose(other({**keys, "contact": {"exponent": exponent}}, reference), reference).causes
    word = "larger" if exponent > 1.5 else "smaller"
    assert cause.startswith(f"the exponent of the contacts is {word} by ")
    value, bound = the_number(cause)
    assert abs(value - abs(exponent - 1.5)) <= bound < 0.01


def test_another_gap_is_named_with_its_difference(right):
    keys, reference = right
    assert causes(other({**keys, "gap": 0.1}, reference), reference) == [
        "the gap of the contacts is larger by 0.1 than the scene says"
    ]


@pytest.mark.parametrize("factor", [0.5, 0.9, 0.99, 1.01, 1.1, 2.0])
def test_times_that_are_too_long_or_short_are_named_with_their_factor(right, factor):
    keys, reference = right
    longer = engine.run(scene(**{**keys, "duration": 2.0 * keys["duration"] + 1.0}).problem())
    shown = replace(at_times(longer, reference.time / factor), time=reference.time, problem=reference.problem)
    (cause,) = diagnose(shown, reference).causes
    assert cause.startswith("times are ")
    value, bound = the_number(cause)
    assert abs(value / factor - 1.0) < 1e-4  # frames 0.1 T apart, by a cubic polynomial
    assert bound < 1e-3 * factor


@pytest.mark.parametrize("factor", [1e-3, 0.5, 2.0, 25.4, 1e3])
@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_other_units_of_one_quantity_are_named_with_their_factor(right, quantity, factor):
    _, reference = right
    shown = replace(reference, **{quantity: factor * getattr(reference, quantity)})
    (cause,) = diagnose(shown, reference).causes
    plural = {"displacement": "displacements", "velocity": "velocities"}[quantity]
    assert cause.startswith(f"{plural} are ")
    assert the_number(cause)[0] == pytest.approx(factor, rel=1e-4)


def test_other_units_of_length_or_time_are_named_where_the_motion_is_consistent(right):
    _, reference = right
    longer = replace(reference, displacement=1e3 * reference.displacement, velocity=1e3 * reference.velocity)
    assert causes(longer, reference) == [
        "displacements and velocities are 1000 times as large as the motion says (another unit?)"
    ]
    slower = replace(reference, time=1e3 * reference.time, velocity=1e-3 * reference.velocity)
    (cause,) = causes(slower, reference)
    assert cause.startswith("times, and velocities as many times smaller, are 1000 times as long")


@pytest.mark.parametrize(("every", "steps"), [(0.5, 1), (0.2, 1), (0.1, 1), (0.1, 2), (0.3, 2)])
def test_a_time_step_that_is_too_long_is_named_with_its_size(right, every, steps):
    keys, _ = right
    problem = scene(**{**keys, "output": {"every": every}}).problem()
    coarse = replace(problem, timestep=every / steps, steps_per_frame=steps)
    shown = replace(engine.run(coarse, scheme=TABLES["verlet"], steps_per_frame=steps), problem=problem)
    (cause,) = diagnose(shown, engine.run(problem)).causes
    assert cause.startswith(f"the time step of {every / steps:.4g} is too long: the scheme verlet")


@pytest.mark.parametrize(("first", "side"), [(1, "earlier"), (-1, "later")])
def test_frames_that_are_shown_earlier_or_later_than_they_are_are_named_with_the_time(first, side):
    """Every fifth of frames 0.02 T apart; those shown are 0.02 T after or before those of their times."""
    fine = engine.run(scene(beads=20, duration=18.0, output={"every": 0.02}).problem())
    reference = Trajectory(fine.problem.coarser(5), fine.time[5:-5:5], fine.displacement[5:-5:5], fine.velocity[5:-5:5])
    shifted = slice(5 + first, fine.frames - 5 + first, 5)
    shown = replace(reference, displacement=fine.displacement[shifted], velocity=fine.velocity[shifted])
    (cause,) = diagnose(shown, reference).causes
    assert cause.startswith("all frames are shown ")
    assert cause.endswith(f" {side} than they are")
    value, bound = the_number(cause)
    assert abs(value - 0.02) <= bound < 0.002
