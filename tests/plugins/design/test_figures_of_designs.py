"""Figures of a search among designs."""

import numpy as np
import pytest

from lammps_inputs.units import Label
from workflow.plugins.design.figures import Objective, front, front_figure, history_figure


@pytest.mark.parametrize(("sign", "best"), [(1.0, [3.0, 3.0, 1.0, 1.0]), (-1.0, [3.0, 3.0, 3.0, 5.0])])
def test_the_best_so_far_is_the_smallest_or_largest_of_what_keeps_the_limits(sign, best):
    (axis,) = history_figure(Objective(Label("force", "", "N"), sign, 4.0), np.array([3.0, np.nan, 1.0, 5.0])).axes
    lines = {line.get_label(): line for line in axis.get_lines()}
    assert lines["best so far"].get_ydata().tolist() == best
    assert lines["best so far"].get_xdata().tolist() == [1, 2, 3, 4]
    assert set(lines["set against"].get_ydata()) == {4.0}
    assert axis.get_ylabel() == "force (N)"


def test_each_front_is_of_what_its_legend_says():
    force, mass = np.array([1.0, 2.0, 3.0, 4.0]), np.array([5.0, 3.0, 9.0, 6.0])
    (axis,) = front_figure(Objective(Label("force"), 1.0, None), force, Label("mass"), mass).axes
    lines = {line.get_label(): line for line in axis.get_lines()}
    assert lines["front to the left"].get_xydata().tolist() == [[3.0, 2.0], [5.0, 1.0]]
    assert lines["front to the right"].get_xydata().tolist() == [[5.0, 1.0], [9.0, 3.0]]


def test_a_front_is_what_nothing_else_betters_in_both():
    one, other = np.array([1.0, 2.0, 2.0, 3.0, 4.0]), np.array([5.0, 6.0, 3.0, 3.0, 1.0])
    assert front(one, other).tolist() == [0, 2, 4]
