"""The figure of error against cost."""

import numpy as np
import pytest
from small_problems import problem

from workflow.plugins.trade.figure import work_precision_figure

QUANTITIES = ("velocity", "amplitude", "arrival")
ERRORS = [f"{name}_error" for name in QUANTITIES]


def curve(error, forces):
    return [
        {**dict.fromkeys(ERRORS, e), "seconds": t, "seconds_min": 0.9 * t, "seconds_max": 1.1 * t, "forces": f}
        for t, (e, f) in enumerate(zip(error, forces, strict=True), start=1)
    ]


def drawn(curves, front=((1.0, 1e-2), (2.0, 1e-4))):
    fronts = dict.fromkeys(QUANTITIES, np.array(front))
    return work_precision_figure(problem(), curves, fronts, dict.fromkeys(QUANTITIES, 1e-9))


def lines(axis):
    return {line.get_label(): line for line in axis.get_lines()}


def test_every_method_is_drawn_with_its_front_and_the_uncertainty():
    figure = drawn({"one": curve([1e-2, 1e-4], [10.0, 20.0])})
    over_time = [axis for axis in figure.axes if "wall time" in axis.get_xlabel()]
    assert len(over_time) == 3
    for axis in over_time:
        found = lines(axis)
        assert {"one", "Pareto front", "uncertainty of the reference"} <= set(found)
        np.testing.assert_array_equal(found["one"].get_xydata(), [[1.0, 1e-2], [2.0, 1e-4]])
        np.testing.assert_array_equal(found["Pareto front"].get_ydata(), [1e-2, 1e-4])


def test_a_method_looks_the_same_over_time_and_over_forces_and_infinite_errors_are_left_out():
    figure = drawn({"one": curve([np.inf, 1e-2], [5.0, 10.0]), "two": curve([1e-3], [20.0])})
    for name, forces in (("one", 10.0), ("two", 20.0)):
        several = [lines(axis)[name] for axis in figure.axes]
        assert len({(line.get_color(), line.get_marker()) for line in several}) == 1
        (over,) = (line for line in several if line.axes.get_xlabel() == "force evaluations")
        assert over.get_xdata().tolist() == [forces]


@pytest.mark.slow
def test_an_error_of_zero_is_drawn_at_the_foot():
    figure = drawn({"exact": curve([0.0], [1.0])}, [[1.0, 0.0]])
    figure.draw_without_rendering()
    assert figure.axes[0].get_ylim()[0] > 0.0
