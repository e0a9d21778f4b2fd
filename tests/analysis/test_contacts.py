"""The largest overlap in the frames, from states made by hand."""

import numpy as np
import pytest
from stock_lammps import scene

from analysis.contacts import OverlapMeter, shown_by_frames
from analysis.trajectory import Trajectory
from lammps_inputs import Output


def states(*displacement, **changes):
    x = np.array(displacement, dtype=float)
    problem = scene(chains=x.shape[1], beads=x.shape[2], **changes).problem()
    return Trajectory(problem, np.arange(len(x)) * problem.every, x, np.zeros_like(x))


def found(*blocks):
    return OverlapMeter(blocks[0].problem).read(blocks).value


def test_it_is_how_far_a_bead_has_come_upon_the_next_of_its_chain():
    assert found(states([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]], [[0.5, 0.25, 0.75], [0.0, 0.75, 0.125]])) == 0.625


def test_a_gap_is_taken_off():
    assert found(states([[0.75, 0.0, 0.0]], gap=0.5)) == 0.25
    assert found(states([[0.25, 0.0, 0.0]], gap=0.5)) == -0.25


@pytest.mark.parametrize("order", [1, -1])
def test_blocks_add_up_to_the_whole(order):
    one, two = states([[0.5, 0.0, 0.0]]), states([[0.0, 0.25, 0.0]])
    assert found(*(one, two)[::order]) == 0.5


def test_the_last_bead_that_moves_and_the_first_at_rest_touch():
    assert found(states([[0.0, 0.0, 0.5, 0.0, 0.0, 0.0]])) == 0.5


@pytest.mark.parametrize(
    ("output", "shown"),
    [(Output(every=0.25), True), (Output(every=0.26), False), (Output(every=0.1, beads=(1, 2, 3)), False)],
)
def test_frames_far_apart_or_of_some_beads_do_not_show_it(output, shown):
    assert shown_by_frames(scene(beads=9, output=output).problem()) is shown
