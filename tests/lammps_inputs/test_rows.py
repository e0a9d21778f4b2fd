"""Which beads exist, and which of them a frame holds."""

import numpy as np
import pytest
from small_problems import problem

from lammps_inputs.limits.rates import front_speed
from lammps_inputs.rows import Rows

ALL = Rows(20)
KINDS = {"all": ALL, "some": ALL.only((3, 7, 20)), "near the front": Rows(100).near_front(64)}


@pytest.mark.parametrize(("kind", "complete", "neighbours"), [("all", True, True), ("some", False, False)])
def test_frames_are_complete_with_all_beads_alone_and_a_list_lacks_neighbours(kind, complete, neighbours):
    assert (KINDS[kind].complete, KINDS[kind].neighbours) == (complete, neighbours)


def test_rows_near_the_front_have_their_neighbours_and_are_not_complete():
    rows = KINDS["near the front"]
    assert rows.follow
    assert rows.neighbours
    assert not rows.complete


@pytest.mark.parametrize(("kind", "existing", "count"), [("all", 20, 20), ("some", 20, 3), ("near the front", 64, 64)])
def test_beads_that_are_not_recorded_exist_and_those_far_from_the_front_do_not(kind, existing, count):
    assert (KINDS[kind].existing, KINDS[kind].count) == (existing, count)


def test_a_bead_has_the_position_that_its_number_has_among_those_held():
    rows = KINDS["some"]
    assert rows.positions(rows.numbers).tolist() == [0, 1, 2]
    assert int(ALL.positions(7)) == 6


def test_positions_in_rows_that_follow_count_from_the_first_and_lie_outside_for_beads_not_held():
    rows = KINDS["near the front"]
    assert rows.positions([30, 31, 94, 95], first=31).tolist() == [-1, 0, 63, 64]


@pytest.mark.parametrize("width", [None, 20, 21])
def test_rows_as_wide_as_the_chains_are_all_rows(width):
    assert ALL.near_front(width) == ALL


def test_a_list_of_all_beads_is_all_beads():
    assert ALL.only(range(1, 21)) == ALL


@pytest.mark.parametrize(
    ("first", "second", "shared"),
    [
        (ALL, ALL, ALL),
        (ALL, ALL.only((2, 5)), ALL.only((2, 5))),
        (ALL.only((2, 5)), ALL.only((5, 6)), ALL.only((5,))),
        (Rows(300).near_front(64), Rows(300).near_front(128), Rows(300).near_front(64)),
        (Rows(300).near_front(64), Rows(300), Rows(300).near_front(64)),
    ],
)
def test_two_problems_share_the_beads_that_both_hold(first, second, shared):
    assert first.shared(second) == second.shared(first) == shared


@pytest.mark.parametrize(("kind", "key"), [("some", "`output.beads`"), ("near the front", "`window`")])
def test_the_sentence_on_missing_beads_names_the_key_to_leave_out(kind, key):
    assert key in KINDS[kind].missing
    assert f"{KINDS[kind].count} of {KINDS[kind].beads}" in KINDS[kind].missing


def test_nothing_is_missing_from_complete_frames():
    assert ALL.missing == ""


def test_a_problem_refuses_rows_of_chains_of_another_length():
    with pytest.raises(ValueError, match="rows of 20 beads, but the chains have 8"):
        problem(rows=ALL)


def test_a_run_near_the_front_stops_only_between_two_looks_at_it():
    near, every = problem(beads=100, window=64), problem(beads=100)
    assert every.steps_between_stops == 1
    assert near.steps_between_stops == np.floor(2.0 / near.timestep / front_speed(near.system))
