"""Figures of periodic states and of responses to a drive."""

import numpy as np
import pytest
from figure_table import assert_shown, at_both_widths

from lammps_inputs.units import Label
from workflow.plugins.modes import branch_figures

NUMBERS, SHAPE = np.linspace(0.1, 1.0, 4), np.array([[1.0, -0.5, 0.2]])
BRANCH = branch_figures.BranchCurve(
    name="mode 2",
    last_state="state 3, energy 1",
    energy=NUMBERS,
    frequency=1.0 - 0.5 * NUMBERS,
    stable=np.array([True, True, False, False]),
    bifurcations=np.array([[0.5, 0.75]]),
    linear=SHAPE,
    last=2.0 * SHAPE[:, ::-1],
    multipliers=np.exp(1j * NUMBERS),
    motion=np.add.outer(0.1 * np.arange(5.0), SHAPE),
    period=3.0,
    chains=1,
)
ENERGY, FREQUENCY, LENGTH, TIME = Label("energy", "U"), Label("frequency", "f"), Label("displacement"), Label("time")
CURVE = np.array([[0.1, 1.0], [0.2, 2.0], [0.15, 3.0], [0.3, 0.5]])
MARKED = {"folds": CURVE[1:3], "upwards": CURVE[:1], "downwards": CURVE[3:], "none": CURVE[:0]}
STABLE = np.array([True, True, False, True])

FIGURES = {
    "frequency": lambda: branch_figures.frequency_figure([BRANCH], np.array([0.6, 9.0]), (ENERGY, FREQUENCY), "case"),
    "shape": lambda: branch_figures.shape_figure([BRANCH], "case"),
    "multipliers": lambda: branch_figures.multiplier_figure([BRANCH], "case"),
    "motion": lambda: branch_figures.motion_figure([BRANCH], (LENGTH, TIME), "case"),
    "response": lambda: branch_figures.response_figure(CURVE, STABLE, MARKED, (FREQUENCY, LENGTH), "case"),
}


@at_both_widths
@pytest.mark.parametrize("name", FIGURES)
def test_figures_of_periodic_states_name_the_state_and_tell_it_from_the_linear_mode(name, width, golden):
    assert_shown(name, FIGURES[name], width, golden)
