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


@pytest.mark.parametrize(
    ("moved", "gap", "overlap"),
    [
        ([[[0.0] * 3, [0.0] * 3], [[0.5, 0.25, 0.75], [0.0, 0.75, 0.125]]], 0.0, 0.625),
        ([[[0.75, 0.0, 0.0]]], 0.5, 0.25),
        ([[[0.25, 0.0, 0.0]]], 0.5, -0.25),
        ([[[0.0, 0.0, 0.5, 0.0, 0.0, 0.0]]], 0.0, 0.5),
    ],
)
def test_it_is_how_far_a_bead_has_come_upon_the_next_of_its_chain_beyond_the_gap(moved, gap, overlap):
    assert found(states(*moved, gap=gap)) == overlap


@pytest.mark.parametrize(
    ("output", "shown"),
    [(Output(every=0.25), True), (Output(every=0.26), False), (Output(every=0.1, beads=(1, 2, 3)), False)],
)
def test_frames_far_apart_or_of_some_beads_do_not_show_it(output, shown):
    assert shown_by_frames(scene(beads=9, output=output).problem()) is shown
