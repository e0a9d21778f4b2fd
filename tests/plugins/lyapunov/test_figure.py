"""The figure of Lyapunov exponents."""

import numpy as np
import pytest
from figure_table import assert_shown, at_both_widths

from lammps_inputs.units import Label
from workflow.plugins.lyapunov import figure

NONE = np.full(2, np.nan)


def drawn(exponents, errors, bounds):
    runs = [figure.Convergence(f"run {k}", np.array([1.0, 10.0, 100.0]), k / np.arange(1.0, 4.0)) for k in (1, 2)]
    return figure.draw(runs, exponents, errors, bounds, (Label("exponent", "\\lambda"), Label("time", "t")), "case")


FIGURES = {
    "largest": lambda: drawn(np.array([0.3]), np.array([0.1]), NONE[:1]),
    "several": lambda: drawn(np.array([0.3, np.nan]), np.array([0.1, np.nan]), np.array([np.nan, 0.2])),
    "none": lambda: drawn(NONE, NONE, np.array([0.2, 0.1])),
}


@at_both_widths
@pytest.mark.parametrize("name", FIGURES)
def test_the_figure_shows_exponents_with_uncertainties_or_bounds(name, width, golden):
    assert_shown(name, FIGURES[name], width, golden)
