"""Impulses against what equal beads must exchange, momentum, and published numbers of gapped beads."""

import math

import numpy as np
import pytest
from small_problems import problem

from analysis.sharing.impulses import measure, relative_difference
from analysis.trajectory import joined
from workflow.engines.reference import engine

EVERY = 0.1
STEP = 0.02
"""Step of the reference here, whose own error is then some 1e-7."""

ERROR = 1e-6
"""Of an impulse at the default cadence (a third of it is seen), and of the reference at this step."""

TWICE = ((1, 1, 1.0), (1, 2, 0.2))
"""Bead 1 hands 0.8 on to bead 2, which loses all to bead 3, and later the 0.2 that it was left with."""


def make_problem(
    chains=1, beads=2, kicks=((1, 1, 1.0),), kappa=0.0, gap=1.0, duration=10.0, every=EVERY, recorded=None
):
    frames = math.ceil(duration / every - 1e-9)
    times = {"timestep": every, "steps_per_frame": 1, "frames": frames, "recorded": recorded}
    return problem(chains=chains, beads=beads, kicks=kicks, kappa=kappa, gap=gap, **times)


def blocks(problem):
    return engine.blocks(problem, steps_per_frame=math.ceil(problem.every / STEP))


def hertz(**changes):
    problem = make_problem(**changes)
    return measure(problem, blocks(problem))


@pytest.mark.parametrize(("every", "error"), [(0.05, ERROR), (0.1, ERROR), (0.3, ERROR), (0.5, 2e-5), (1.0, 4e-4)])
def test_a_bead_hands_all_its_momentum_on(every, error):
    found = hertz(every=every)
    assert found.first == pytest.approx(1.0, abs=error)
    assert found.total == found.first
    assert found.contacts == 1
    assert found.bead.tolist() == [2]


def test_a_contact_has_its_time_in_its_middle():
    # 2.438838 long, and symmetric in time
    assert hertz().time == pytest.approx(1.0 + 2.438838 / 2.0, abs=5e-6)


def test_first_and_later_contacts_are_told_apart():
    found = hertz(beads=3, kicks=TWICE, gap=5.0, duration=60.0)
    np.testing.assert_allclose(found.first[0], [0.8, 1.0], rtol=0, atol=2.0 * ERROR)
    np.testing.assert_allclose(found.total[0], [1.0, 1.0], rtol=0, atol=2.0 * ERROR)
    assert found.contacts.tolist() == [[2, 1]]


def test_a_contact_that_lasts_counts_so_far():
    problem = make_problem(duration=2.0)
    last = joined(blocks(problem)).velocity[-1, 0, 1]
    assert 0.1 < last < 0.9
    assert measure(problem, blocks(problem)).first == pytest.approx(last, abs=ERROR)


def test_beads_that_overlap_at_no_frame_but_between_are_in_contact():
    # contacts of duration 2.44 seen every 3 T, from gaps that put one wholly between two frames
    found = [hertz(every=3.0, gap=gap, duration=12.0).contacts for gap in (3.1, 3.3, 3.5)]
    assert np.all(np.array(found) == 1)


def test_contacts_one_after_the_other_each_between_two_frames_are_all_seen():
    # bead 2 is struck from 5.48 to 7.92, and strikes bead 3 from 12.18 to 14.62; frames are 4 T apart
    found = hertz(beads=3, every=4.0, gap=5.48, duration=24.0)
    assert found.contacts.tolist() == [[1, 1]]


def test_the_impulses_of_a_row_are_the_momentum_that_the_beads_ahead_gain():
    found = hertz(chains=3, beads=20, kappa=0.3, gap=0.4, duration=40.0)
    assert 0.0 < found.imbalance < 10 * ERROR  # which add up over the contacts of three chains
    touching = hertz(chains=2, beads=20, kappa=0.3, gap=0.0, duration=20.0)
    assert 0.0 < touching.imbalance < 10 * ERROR


def test_a_wrong_impulse_shows_in_the_imbalance():
    problem = make_problem(chains=2, beads=10, kappa=0.3, gap=0.4, duration=20.0)
    whole = joined(blocks(problem))
    whole.displacement[:, 1] *= 1.001
    assert measure(problem, [whole]).imbalance > 1e-4


def test_neighbours_that_are_recorded_are_enough():
    every_bead = hertz(chains=2, beads=12, kappa=0.3, gap=0.4, duration=20.0)
    some = hertz(chains=2, beads=12, kappa=0.3, gap=0.4, duration=20.0, recorded=(1, 3, 4, 5, 9))
    assert some.bead.tolist() == [4, 5]
    assert math.isnan(some.imbalance)
    places = [every_bead.row(4), every_bead.row(5)]
    np.testing.assert_allclose(some.first, every_bead.first[:, places], rtol=0, atol=ERROR)
    with pytest.raises(ValueError, match="bead 9 and the bead behind it"):
        some.row(9)


def test_what_was_never_struck_has_no_impulse_and_no_time():
    found = hertz(beads=5, duration=4.0)
    assert found.contacts[0].tolist() == [1, 1, 0, 0] or found.contacts[0].tolist() == [1, 0, 0, 0]
    assert found.first[0, -1] == found.total[0, -1] == 0.0
    assert math.isnan(found.time[0, -1])


def test_the_difference_of_chains_is_relative_to_their_mean():
    np.testing.assert_allclose(relative_difference(np.array([[1.0, 0.9, 0.0], [1.0, 1.1, 0.0]])), [0.0, 0.2, math.nan])


@pytest.mark.parametrize(
    ("kappa", "gap", "bead", "published"),
    [
        (1.0, 0.909, 25, (0.528, 0.528)),
        (0.1, 2.874, 5, (0.342, 0.724)),
        (0.1, 2.874, 25, (0.569, 0.487)),
        (0.1, 2.874, 100, (0.527, 0.527)),
    ],
)
def test_gapped_hertz_rows_have_the_published_impulses(kappa, gap, bead, published):
    duration = bead * (gap / 0.5 + 1.5) + 40.0
    found = hertz(chains=2, beads=bead + 5, kappa=kappa, gap=gap, duration=duration, every=0.2)
    np.testing.assert_allclose(found.first[:, found.row(bead)], published, rtol=0, atol=5e-4)
    assert found.first[:, found.row(bead)] == pytest.approx(found.total[:, found.row(bead)], abs=1e-12)
