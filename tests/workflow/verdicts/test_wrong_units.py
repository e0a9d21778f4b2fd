"""Trajectories of another law, another time step or other units: what is named as the cause, with its size."""

import re
from dataclasses import replace
from typing import Any

import pytest
from plain_scene import scene
from wrong_runs import causes

from analysis.compare.common_times import at_times
from analysis.trajectory import Trajectory
from workflow.engines.reference import engine
from workflow.prepare.pilot import TABLES
from workflow.verdicts.diagnose import diagnose

KEYS: dict[str, Any] = {"beads": 20, "duration": 18.0, "output": {"every": 0.1}}
ONE: dict[str, Any] = {**KEYS, "chains": 1, "coupling": None}
SCENES = {"one chain": ONE, "two chains": KEYS}


@pytest.fixture(scope="module", params=SCENES)
def right(request: pytest.FixtureRequest) -> tuple[dict[str, Any], Trajectory]:
    """Keys of a scene, and its motion."""
    keys = SCENES[request.param]
    return keys, engine.run(scene(**keys).problem())


def other(keys: dict[str, Any], reference: Trajectory) -> Trajectory:
    """The motion of other keys, claimed to be that of the reference's scene."""
    return replace(engine.run(scene(**keys).problem()), problem=reference.problem)


def the_number(sentence: str) -> tuple[float, float]:
    """The only number of a sentence that has an uncertainty, and that."""
    ((value, bound),) = re.findall(r"(\S+)(?: [A-Z])? \(± ([^)]*)\)", sentence)
    return float(value), float(bound)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1.0, 1.3, 1.4, 1.6, 2.0])
def test_another_exponent_is_named_with_its_difference(right: Any, exponent: float) -> None:
    keys, reference = right
    (cause,) = diagnose(other({**keys, "contact": {"exponent": exponent}}, reference), reference).causes
    word = "larger" if exponent > 1.5 else "smaller"
    assert cause.startswith(f"the exponent of the contacts is {word} by ")
    value, bound = the_number(cause)
    assert abs(value - abs(exponent - 1.5)) <= bound < 0.01


def test_another_gap_is_named_with_its_difference(right: Any) -> None:
    keys, reference = right
    assert causes(other({**keys, "gap": 0.1}, reference), reference) == [
        "the gap of the contacts is larger by 0.1 than the scene says"
    ]


@pytest.mark.parametrize("factor", [0.5, 0.9, 0.99, 1.01, 1.1, 2.0])
def test_times_that_are_too_long_or_short_are_named_with_their_factor(right: Any, factor: float) -> None:
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
def test_other_units_of_one_quantity_are_named_with_their_factor(right: Any, quantity: str, factor: float) -> None:
    _, reference = right
    shown = replace(reference, **{quantity: factor * getattr(reference, quantity)})
    (cause,) = diagnose(shown, reference).causes
    plural = {"displacement": "displacements", "velocity": "velocities"}[quantity]
    assert cause.startswith(f"{plural} are ")
    assert the_number(cause)[0] == pytest.approx(factor, rel=1e-4)


def test_other_units_of_length_or_time_are_named_where_the_motion_is_consistent(right: Any) -> None:
    _, reference = right
    longer = replace(reference, displacement=1e3 * reference.displacement, velocity=1e3 * reference.velocity)
    assert causes(longer, reference) == [
        "displacements and velocities are 1000 times as large as the motion says (another unit?)"
    ]
    slower = replace(reference, time=1e3 * reference.time, velocity=1e-3 * reference.velocity)
    (cause,) = causes(slower, reference)
    assert cause.startswith("times, and velocities as many times smaller, are 1000 times as long")


@pytest.mark.parametrize(("every", "steps"), [(0.5, 1), (0.2, 1), (0.1, 1), (0.1, 2), (0.3, 2)])
def test_a_time_step_that_is_too_long_is_named_with_its_size(right: Any, every: float, steps: int) -> None:
    keys, _ = right
    problem = scene(**{**keys, "output": {"every": every}}).problem()
    coarse = replace(problem, timestep=every / steps, steps_per_frame=steps)
    shown = replace(engine.run(coarse, scheme=TABLES["verlet"], steps_per_frame=steps), problem=problem)
    (cause,) = diagnose(shown, engine.run(problem)).causes
    assert cause.startswith(f"the time step of {every / steps:.4g} is too long: the scheme verlet")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"coupling": {"stiffness": 0.11}}, "the coupling is 1.1 times as strong as the scene says"),
        (
            {"kinds": {"a": {"mass": 1.1}}, "replace": {"bead": 5, "kind": "a"}},
            "bead 5 of chain 1 is 1.1 times as heavy as the scene says",
        ),
        ({"damping": {"beads": 0.01}}, "the bead damping of 0.01 m/T is not in the scene"),
    ],
)
def test_other_forces_and_masses_are_not_taken_for_units_or_steps(changes: dict[str, Any], sentence: str) -> None:
    reference = engine.run(scene(**KEYS).problem())
    assert causes(other({**KEYS, **changes}, reference), reference) == [sentence]


@pytest.mark.slow
def test_a_force_that_is_no_power_is_named_without_a_number() -> None:
    reference = engine.run(scene(**KEYS).problem())
    hardening = {"coupling": {"stiffness": 0.1, "cubic": 0.3}}
    assert causes(other({**KEYS, **hardening}, reference), reference) == [
        "the coupling does not follow the law of the scene: the force is another function of the overlap or strain"
    ]
