"""The figure of error against cost."""

import numpy as np
import pytest
from figure_table import assert_shown, at_both_widths
from small_problems import problem

from workflow.plugins.trade.figure import work_precision_figure

QUANTITIES = ("velocity", "amplitude", "arrival")


def curve(error, forces):
    settings = zip(error, forces, strict=True)
    return [
        {
            **{f"{name}_error": e for name in QUANTITIES},
            "seconds": t,
            "seconds_min": 0.9 * t,
            "seconds_max": 1.1 * t,
            "forces": f,
        }
        for t, (e, f) in enumerate(settings, start=1)
    ]


def drawn(curves, front=((1.0, 1e-2), (2.0, 1e-4))):
    fronts = dict.fromkeys(QUANTITIES, np.array(front))
    return work_precision_figure(problem(), curves, fronts, dict.fromkeys(QUANTITIES, 1e-9))


FIGURES = {
    "two-methods": lambda: drawn({"one": curve([np.inf, 1e-2, 1e-4], [5.0, 10.0, 20.0]), "two": curve([1e-3], [20.0])}),
    "error-of-0": lambda: drawn({"exact": curve([0.0], [1.0])}, [[1.0, 0.0]]),
}


@pytest.mark.slow
@at_both_widths
@pytest.mark.parametrize("name", FIGURES)
def test_the_figure_shows_every_method_its_front_and_the_uncertainty(name, width, golden):
    assert_shown(name, FIGURES[name], width, golden)
