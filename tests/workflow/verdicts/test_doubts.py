"""From which difference on something is named as the cause: measurements made up, each once within and once beyond."""

from dataclasses import replace

import numpy as np
import pytest
from small_problems import written_down

from analysis.against import symptoms
from lammps_inputs import library, physics
from workflow.engines.reference.step_halving import Uncertainty
from workflow.verdicts import validate

PLAIN = {"name": "test", "chains": 2, "beads": 8, "kick": {"velocity": 1.0}, "duration": 2.0}

SPRINGS, GROUND = {"coupling": {"stiffness": 0.1}}, {"foundation": {"stiffness": 0.5}}

PUSH = {"push": {"chain": 2, "bead": 3, "peak": 1.0, "duration": 1.0, "shape": "half-sine"}}

DRIVE = {"drive": {"chain": 2, "bead": 3, "force": 1.0, "frequency": 0.5, "phase": 30.0}}

LOAD = {"precompression": {"force": 1.0}}


def springs(factor):
    return symptoms, "identify_springs", lambda _: symptoms.Springs(np.full((1, 8), 0.1 * factor), 0.0, 0.0)


def ground(factor):
    return (
        symptoms,
        "identify_strengths",
        lambda _: symptoms.Strengths({"contacts": 1.0, "foundation": factor}, 0.0, 0.0),
    )


def load(factor):
    return symptoms, "identify_load", lambda _: symptoms.StaticLoad(factor, 1.0)


def exponent(factor):
    return symptoms, "identify_exponent", lambda _: 1.5 * factor


def mass(factor):
    one = np.ones((2, 8))
    one[1, 4] = factor
    return symptoms, "identify_beads", lambda _: symptoms.Felt(one, np.ones((2, 7)))


def contact(factor):
    one = np.ones((2, 7))
    one[1, 4] = factor
    return symptoms, "identify_beads", lambda _: symptoms.Felt(np.ones((2, 8)), one)


def push(factor):
    return symptoms, "impulse_given", lambda trajectory, load: factor * load.impulse(trajectory.time)


def turned(degrees):
    """From 1 on, which is none."""

    def given(trajectory, load):
        law = load.law._replace(phase=load.law.phase + np.radians(degrees - 1.0))
        return replace(load, law=law).impulse(trajectory.time)

    return symptoms, "impulse_given", given


def without_symptoms(keys, monkeypatch):
    """Two trajectories in which nothing is measured to be wrong."""
    problem = library.from_plain({**PLAIN, **keys}, "test").problem()
    for name in ("identify_springs", "identify_strengths", "identify_load", "identify_exponent", "identify_beads"):
        monkeypatch.setattr(symptoms, name, lambda _: None)
    monkeypatch.setattr(symptoms, "impulse_given", lambda trajectory, load: load.impulse(trajectory.time))
    return [
        written_down(problem, lambda t: (0.0 * t, physics.initial_velocity(problem.system) + 0.0 * t)) for _ in "ab"
    ]


@pytest.mark.parametrize(
    ("keys", "measured", "within", "beyond", "said"),
    [
        (SPRINGS, springs, 1.0004, 1.001, "the coupling is 0.1001 instead of 0.1"),
        (GROUND, ground, 1.0004, 1.001, "the foundation is 1.001 times as strong"),
        (LOAD, load, 1.004, 1.008, "the forces that hold the beads at rest are 1.008 times"),
        ({}, exponent, 1.0005, 1.001, "the contacts have the exponent 1.501 instead of 1.5"),
        ({}, mass, 1.009, 1.012, "bead 5 of chain 2 is 1.012 times as heavy"),
        ({}, contact, 1.009, 1.012, "the contact of beads 5 and 6 of chain 2 is 1.012 times as strong"),
        (PUSH, push, 1.004, 1.008, "the push is 1.008 times as strong"),
        (DRIVE, turned, 2.0, 3.0, "the drive has a phase of 32 instead of 30 degrees"),
    ],
    ids=["springs", "ground", "load", "exponent", "mass", "contact", "push", "phase"],
)
def test_a_cause_is_named_beyond_its_doubt_and_not_within(keys, measured, within, beyond, said, monkeypatch):
    own, reference = without_symptoms(keys, monkeypatch)
    module, name, _ = measured(1.0)
    for factor in (within, beyond):
        right, wrong = measured(1.0)[2], measured(factor)[2]
        # the first argument of each is the trajectory that is measured
        monkeypatch.setattr(
            module,
            name,
            lambda trajectory, *more, wrong=wrong, right=right: (wrong if trajectory is own else right)(
                trajectory, *more
            ),
        )
        found = causes(own, reference)
        if factor == within:
            assert found == []
        else:
            (cause,) = found
            assert cause.startswith(said)


def test_what_differs_by_little_beside_what_differs_by_much_is_not_named(monkeypatch):
    own, reference = without_symptoms({**GROUND, "walls": {"right": "bead"}}, monkeypatch)

    def measured(trajectory):
        factors = (1.5, 1.001) if trajectory is own else (1.0, 1.0)
        return symptoms.Strengths(dict(zip(("foundation", "right_wall"), factors, strict=True)), 0.0, 0.0)

    monkeypatch.setattr(symptoms, "identify_strengths", measured)
    assert causes(own, reference) == ["the foundation is 1.5 times as strong as the scene says"]


@pytest.mark.parametrize(
    ("velocity", "displacement", "said"),
    [(0.98, 0.98, ["all frames are shown 0.02 earlier than they are"]), (0.96, 0.98, []), (0.98, 0.96, [])],
)
def test_a_shift_in_time_is_named_where_it_explains_nearly_all_of_the_difference(
    velocity, displacement, said, monkeypatch
):
    """Of the velocities, which are asked for first, and of the displacements."""
    own, reference = without_symptoms({}, monkeypatch)
    explained = iter((velocity, displacement))
    monkeypatch.setattr(symptoms, "time_shift", lambda *_: symptoms.Shift(0.02, next(explained)))
    assert causes(own, reference) == said


def uncertainty(velocity, arrival):
    return Uncertainty(steps_per_frame=2, velocity=velocity, arrival=arrival, energy=0.0, momentum=0.0)


@pytest.mark.parametrize(("velocity", "arrival", "doubted"), [(5e-4, 2e-3, []), (6e-4, 0.0, ["velocity"])])
def test_a_reference_is_doubted_that_is_less_sure_than_a_tolerance(velocity, arrival, doubted):
    for sure, names in ((uncertainty(velocity, arrival), doubted), (uncertainty(0.0, 2.1e-3), ["arrival"])):
        said = validate._doubts(sure, validate.TOLERANCES)
        assert [line.split(" in ")[1].split(",")[0] for line in said] == names


def test_the_reference_takes_more_steps_until_it_is_four_times_surer_than_a_tolerance(monkeypatch):
    """One whose uncertainties halve as its steps double, from 1e-3 at ten steps a frame."""

    class Halving:
        def __init__(self, _, *, steps_per_frame=None):
            self.steps = steps_per_frame or 10

        def run(self):
            return replace(uncertainty(1e-2 / self.steps, 1e-2 / self.steps), steps_per_frame=self.steps)

    monkeypatch.setattr(validate, "StepHalving", Halving)
    for limits, steps in (({"velocity": 4e-3}, 10), ({"velocity": 3.9e-3}, 20), ({"arrival": 1e-3}, 40)):
        assert validate._accurate_enough(None, {"velocity": 1.0, "arrival": 1.0, **limits}).steps == steps


def test_where_energy_is_exchanged_it_may_miss_what_velocities_may():
    for keys, energy in (({}, 1e-4), ({"damping": {"beads": 0.1}}, 5e-4), (PUSH, 5e-4)):
        problem = library.from_plain({**PLAIN, **keys}, "test").problem()
        assert validate.limits_of(problem, None) == {**validate.TOLERANCES, "energy": energy}
        assert validate.limits_of(problem, {"energy": 1.0})["energy"] == 1.0
