"""What a wall gives back, from pulses made by hand."""

import numpy as np
import pytest
from small_problems import problem

from analysis.gauges.restitution import CLEAR, restitution
from analysis.tracking.pulses import Pulse

BEADS = 60


def pulse(chain, direction, beads, start, peak):
    """At these beads in this order, a bead a time."""
    beads = np.array(beads)
    velocity = np.array([peak(bead) for bead in beads])
    return Pulse(chain, direction, beads, start + np.arange(len(beads)), velocity, np.ones(len(beads)))


@pytest.mark.parametrize("right", [True, False])
def test_it_is_the_ratio_of_velocities_at_one_bead_clear_of_the_wall(right):
    """Chain 1 gives back less the farther off that is seen; a later pulse is higher; chain 2 gives back nothing."""
    towards = 1 if right else -1

    def at(distance):
        return BEADS - distance if right else 1 + distance

    def away(bead):
        return BEADS - bead if right else bead - 1

    there, back = [at(d) for d in range(50, 2, -1)], [at(d) for d in range(3, 51)]
    pulses = (
        pulse(1, towards, there, 100.0, lambda _: 2.0),
        pulse(2, towards, there, 0.0, lambda _: 1.0),
        pulse(1, -towards, back, 160.0, lambda _: 1.9),
        pulse(1, -towards, back, 60.0, lambda bead: 0.9 - 0.001 * away(bead)),
        pulse(1, towards, there, 0.0, lambda bead: 1.0 + 0.01 * away(bead)),
    )
    found = restitution(pulses, problem(beads=BEADS), right=right)
    assert found[0] == pytest.approx((0.9 - 0.001 * CLEAR) / (1.0 + 0.01 * CLEAR))
    assert np.isnan(found[1])


def test_a_ripple_that_runs_ahead_of_the_pulse_is_not_what_the_wall_throws_back():
    pulses = (
        pulse(1, 1, range(26, 48), 0.0, lambda _: 0.03),
        pulse(1, 1, range(10, 58), 5.0, lambda _: 0.4),
        pulse(1, -1, range(57, 20, -1), 54.0, lambda _: 0.02),
        pulse(1, -1, range(57, 10, -1), 60.0, lambda _: 0.3),
    )
    assert restitution(pulses, problem(beads=BEADS), right=True)[0] == pytest.approx(0.75)
