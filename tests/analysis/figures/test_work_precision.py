"""The figure of error against cost."""

import numpy as np
import pytest
from small_problems import problem

from analysis.figures.work_precision import Curve, work_precision_figure

QUANTITIES = ("velocity", "amplitude", "arrival")


def curve(name, error, forces):
    seconds = np.arange(1.0, 1.0 + len(error))
    errors = dict.fromkeys(QUANTITIES, np.array(error))
    return Curve(name, errors, seconds, 0.9 * seconds, 1.1 * seconds, np.array(forces))


def drawn(curves, fronts):
    figure = work_precision_figure(problem(), curves, fronts, dict.fromkeys(QUANTITIES, 1e-9))
    figure.draw_without_rendering()
    return figure


def test_every_method_is_drawn_with_its_front_and_the_floor():
    front = dict.fromkeys(QUANTITIES, np.array([[1.0, 1e-2], [2.0, 1e-4]]))
    figure = drawn([curve("one", [1e-2, 1e-4], [10.0, 20.0])], front)
    over_time = [axis for axis in figure.axes if "wall time" in axis.get_xlabel()]
    assert len(over_time) == 3
    for axis in over_time:
        lines = {line.get_label(): line for line in axis.get_lines()}
        assert {"one", "Pareto front", "uncertainty of the reference"} <= set(lines)
        np.testing.assert_array_equal(lines["one"].get_xydata(), [[1.0, 1e-2], [2.0, 1e-4]])
        np.testing.assert_array_equal(lines["Pareto front"].get_ydata(), [1e-2, 1e-4])


@pytest.mark.slow
def test_a_method_looks_the_same_over_time_and_over_forces():
    front = dict.fromkeys(QUANTITIES, np.zeros((0, 2)))
    figure = drawn([curve("one", [1e-2], [10.0]), curve("two", [1e-3], [20.0])], front)
    for name, forces in (("one", 10.0), ("two", 20.0)):
        lines = [next(line for line in axis.get_lines() if line.get_label() == name) for axis in figure.axes]
        assert len({(line.get_color(), line.get_marker()) for line in lines}) == 1
        (over,) = (
            line for axis, line in zip(figure.axes, lines, strict=True) if axis.get_xlabel() == "force evaluations"
        )
        assert over.get_xdata().tolist() == [forces]


def test_runs_gone_bad_are_left_out_and_methods_without_forces_are_drawn_over_time_alone():
    curves = [curve("bad", [np.inf, 1e-3], [1.0, 2.0]), curve("rigid", [0.5], [np.nan])]
    figure = drawn(curves, dict.fromkeys(QUANTITIES, np.zeros((0, 2))))
    for axis in figure.axes:
        lines = {line.get_label(): line for line in axis.get_lines()}
        np.testing.assert_array_equal(lines["bad"].get_ydata(), [1e-3])
        assert ("rigid" in lines) is ("wall time" in axis.get_xlabel())


@pytest.mark.slow
@pytest.mark.parametrize("error", [0.0, 1e-300])
def test_an_error_of_zero_is_drawn_at_the_foot(error):
    figure = drawn([curve("exact", [error], [1.0])], dict.fromkeys(QUANTITIES, np.array([[1.0, error]])))
    assert figure.axes[0].get_ylim()[0] > 0.0
