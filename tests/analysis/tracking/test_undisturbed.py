"""Which passages neither an end nor another pulse has disturbed, of pulses at exactly known places."""

import numpy as np
import pytest
from synthetic_waves import exact_waves, problem

from analysis.shape.exact_wave import solitary_wave
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import find_peaks
from analysis.tracking.pulses import Pulse
from analysis.tracking.undisturbed import APART, CLEAR, clear_of_ends, clear_of_others, once_each, returns

MIDDLE = range(8, 34)
"""Beads that are recorded."""

SPEED = float(solitary_wave().speed_at(1.0))


def passing(first=1, last=40, *, start=0.0, chain=1, direction=1):
    """A pulse of velocity 1 that is at bead 1 (40, towards lower ones) at a time."""
    bead = np.arange(first, last + 1)[::direction]
    arrival = start + ((bead - 1) if direction > 0 else (40 - bead)) / SPEED
    one, zero = np.ones(len(bead)), np.zeros(len(bead))
    return Pulse(chain, direction, bead, arrival, one, SPEED * one, zero, zero, zero)


def test_a_pulse_is_clear_of_the_ends_between_five_beads_from_either_until_a_reflection_may_be_back():
    what, pulse = problem(1, 0.0, 40), passing()
    never = np.full((1, 40), np.inf)
    assert CLEAR == 5
    assert pulse.bead[clear_of_ends(pulse, what, never)].tolist() == list(range(6, 36))
    back = np.where(np.arange(1, 41) < 21, np.inf, pulse.arrival)[np.newaxis]
    assert pulse.bead[clear_of_ends(pulse, what, back)].tolist() == list(range(6, 21))


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("recorded", [(1, 2, *MIDDLE, 39, 40), MIDDLE], ids=["with the ends", "without them"])
def test_a_reflection_is_back_after_the_way_to_the_end_and_the_way_back(recorded, direction):
    run = exact_waves([(1.0, 6.0)], every=0.05, recorded=tuple(recorded), direction=direction)
    waves = leading_waves(find_peaks([run], direction=direction), run.problem)
    way, middle = np.arange(40)[::direction], slice(MIDDLE[0] - 1, MIDDLE[-1])
    expected = 2.0 * (6.0 + 39.0 / SPEED) - (6.0 + way / SPEED)
    np.testing.assert_allclose(returns(waves, run.problem, direction)[0, middle], expected[middle], atol=1e-3)


@pytest.mark.parametrize(("beads_behind", "clear"), [(APART - 0.1, False), (APART + 0.1, True)])
def test_a_pulse_is_clear_of_another_that_follows_four_beads_behind_but_of_no_nearer_one(beads_behind, clear):
    pulse, other = passing(), passing(start=beads_behind / SPEED)
    found = clear_of_others(1, pulse.bead, pulse.arrival, [pulse, other], 0.1)
    present = pulse.arrival >= other.arrival[0]
    assert found[present].tolist() == [clear] * int(present.sum())
    assert found[~present].all()
    assert clear_of_others(2, pulse.bead, pulse.arrival, [other], 0.1).all()


def test_of_two_maxima_of_a_passage_that_which_more_beads_have_stays():
    exact = solitary_wave()
    near = float(exact.width) / SPEED
    long, short, late = passing(), passing(last=30, start=0.9 * near), passing(last=30, start=1.1 * near)
    beside, towards = passing(last=30, chain=2), passing(last=30, direction=-1)
    kept = once_each((short, long, late, beside, towards), exact)
    assert [id(pulse) for pulse in kept] == [id(pulse) for pulse in (long, late, beside, towards)]
