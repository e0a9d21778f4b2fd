"""What a wall reflects, from pulses made by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from small_problems import problem
from synthetic_waves import of_keys

from analysis.tracking.pulses import Pulse
from lammps_inputs.facts import Fact
from workflow.measures.forces.reflection import UNCERTAIN, reflections

BEADS = 60
PLAIN = problem(beads=BEADS)


def pulse(chain, direction, beads, start, peak):
    """At these beads in this order, a bead a time."""
    beads = np.array(beads)
    velocity = np.array([peak(bead) for bead in beads])
    return Pulse(
        chain,
        direction,
        beads,
        start + np.arange(len(beads)),
        velocity,
        np.ones(len(beads)),
        *np.zeros((3, len(beads))),
    )


def there_and_back(incident, reflected, right=True):
    """A pulse in chain 1 to the wall and back from 30 beads away, its velocities given by the distance from it."""
    towards, far = (1, lambda bead: BEADS - bead) if right else (-1, lambda bead: bead - 1)
    way = [BEADS - d if right else 1 + d for d in range(30, -1, -1)]
    there = pulse(1, towards, way, 0.0, lambda bead: incident(far(bead)))
    return there, pulse(1, -towards, way[::-1], 31.0, lambda bead: reflected(far(bead)))


@pytest.mark.parametrize("right", [True, False])
def test_velocities_that_decay_on_the_way_are_compared_at_the_wall(right):
    rate = 1e-3
    pulses = there_and_back(lambda d: 2.0 * math.exp(rate * d), lambda d: 1.8 * math.exp(-rate * d), right)
    found, none = reflections(pulses, PLAIN, right=right)
    assert none is None
    assert found.ratio == pytest.approx(0.9, rel=1e-12)
    assert found.uncertainty == pytest.approx(0.9 * UNCERTAIN * rate * math.hypot(5.0, 12.0), rel=1e-9)
    assert (found.incident_beads, found.reflected_beads) == (((46, 55), (48, 39)) if right else ((15, 6), (13, 22)))


def test_the_uncertainty_holds_the_error_of_the_velocities():
    exact = there_and_back(lambda _: 1.0, lambda _: 0.5)
    pulses = tuple(replace(pulse, peak_velocity_error=np.full(len(pulse), 1e-3)) for pulse in exact)
    found = reflections(pulses, PLAIN, right=True)[0]
    assert found.uncertainty == pytest.approx(0.5 * math.hypot(1e-3, 2e-3), rel=1e-6)


@pytest.mark.parametrize(("beads", "known"), [(9, False), (10, True)])
def test_a_ratio_is_of_ten_beads_of_the_incident_pulse_at_least(beads, known):
    there, back = there_and_back(lambda _: 1.0, lambda _: 0.9)
    seen = there.bead > BEADS - 5 - beads  # the nearest five beads are not of the formed wave
    few = pulse(1, 1, there.bead[seen], 30.0 - 4.0 - beads, lambda _: 1.0)
    found = reflections((few, back), PLAIN, right=True)[0]
    assert (found is not None) == known


LOADED = {
    "chains": 2,
    "beads": BEADS,
    "precompression": {"force": 0.1},
    "duration": 1.0,
    "kick": {"velocity": 1.0},
}


@pytest.mark.parametrize(
    "changes",
    [
        {"lacks": frozenset({Fact.PULSE})},
        {"mass": np.tile([1.0, 2.0], (2, BEADS // 2))},
        {"links": of_keys(**LOADED).system.links},
    ],
    ids=["no pulse keeps its shape", "beads that differ", "static load"],
)
def test_no_ratio_is_given_where_a_pulse_does_not_keep_its_velocity(changes):
    pulses = there_and_back(lambda _: 1.0, lambda _: 0.9)
    assert reflections(pulses, PLAIN, right=True)[0] is not None
    assert reflections(pulses, replace(PLAIN, system=replace(PLAIN.system, **changes)), right=True)[0] is None


@pytest.mark.parametrize(("meet", "known"), [(24.0, True), (10.0, False)])
def test_a_reflected_pulse_is_read_before_it_meets_the_next_incident_one(meet, known):
    """It loses a fifth where they meet, so many beads from the wall; the next one is in the chain before it returns."""
    there, back = there_and_back(lambda _: 1.0, lambda d: 0.9 if d < meet else 0.72)
    second = pulse(1, 1, range(1, BEADS + 1), 2.0 * meet - 28.0, lambda _: 0.5)
    found = reflections((there, back, second), PLAIN, right=True)[0]
    assert (found is not None) == known
    if found is not None:
        assert found.ratio == pytest.approx(0.9)


@pytest.mark.parametrize(("time", "ratio"), [(29.9, 0.2), (30.1, 0.5), (79.9, None), (80.1, 0.2)])
def test_only_what_ends_after_the_pulse_meets_the_wall_and_begins_before_the_next_one_does_may_be_its_reflection(
    time, ratio
):
    """They meet it at 30 T and 80 T; the reflection has a velocity of 0.2, what ends or begins at `time` 0.5."""
    there, back = there_and_back(lambda _: 1.0, lambda _: 0.2)
    beads = range(BEADS - 1, 30, -1)
    start = time if time > 50.0 else time - (len(beads) - 1)
    other, second = pulse(1, -1, beads, start, lambda _: 0.5), pulse(1, 1, range(1, BEADS + 1), 21.0, lambda _: 1.0)
    found = reflections((there, back, other, second), PLAIN, right=True)[0]
    assert (found and found.ratio) == (ratio and pytest.approx(ratio))


def test_a_ripple_that_runs_ahead_of_the_pulse_is_not_what_the_wall_reflects():
    pulses = (
        pulse(1, 1, range(26, 48), 0.0, lambda _: 0.03),
        pulse(1, 1, range(10, 58), 5.0, lambda _: 0.4),
        pulse(1, -1, range(57, 20, -1), 54.0, lambda _: 0.02),
        pulse(1, -1, range(57, 10, -1), 60.0, lambda _: 0.3),
    )
    assert reflections(pulses, PLAIN, right=True)[0].ratio == pytest.approx(0.75)
