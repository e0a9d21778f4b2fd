"""Figures of a search among designs."""

import numpy as np
import pytest
from figure_table import assert_shown, at_both_widths

from lammps_inputs.units import Label
from workflow.plugins.design.figures import (
    Objective,
    front,
    front_figure,
    history_figure,
    members_figure,
    wall_figure,
)

FORCE, MASS = Label("force", "F", "N"), Label("mass", "m", "kg")
VALUES = np.array([3.0, np.nan, 1.0, 5.0])


def fronts():
    force, mass = np.array([1.0, 2.0, 3.0, 4.0]), np.array([5.0, 3.0, 9.0, 6.0])
    return front_figure(Objective(FORCE, 1.0, None), force, MASS, mass)


FIGURES = {
    "smallest": lambda: history_figure(Objective(FORCE, 1.0, 4.0), VALUES),
    "largest": lambda: history_figure(Objective(FORCE, -1.0, 4.0), VALUES),
    "fronts": fronts,
    "members": lambda: members_figure(Objective(FORCE, 1.0, 4.0), 2.0, [1.0, 2.0, 2.5, 3.0]),
    "wall": lambda: wall_figure([("as found", VALUES, 1e-4 * VALUES)], Label("time", "t", "s"), FORCE),
}


@at_both_widths
@pytest.mark.parametrize("name", FIGURES)
def test_figures_show_the_best_of_what_keeps_the_limits_and_the_fronts(name, width, golden):
    assert_shown(name, FIGURES[name], width, golden)


def test_a_front_is_what_nothing_else_betters_in_both():
    first, second = np.array([1.0, 2.0, 2.0, 3.0, 4.0]), np.array([5.0, 6.0, 3.0, 3.0, 1.0])
    assert front(first, second).tolist() == [0, 2, 4]
