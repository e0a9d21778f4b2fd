"""Figures of periodic states."""

import numpy as np

from lammps_inputs import units
from workflow.plugins.modes import branch_figures


def test_figures_of_periodic_states_name_the_state_and_tell_it_from_the_linear_mode():
    numbers, shape = np.linspace(0.1, 1.0, 3), np.array([[1.0, -0.5, 0.2]])
    branch = branch_figures.BranchCurve(
        name="mode 2",
        last_state="state 3, energy 1",
        energy=numbers,
        frequency=numbers,
        stable=np.ones(3, dtype=bool),
        bifurcations=np.zeros((0, 2)),
        linear=shape,
        last=shape,
        multipliers=np.exp(1j * numbers),
        motion=np.ones((5, 1, 3)),
        period=1.0,
        chains=1,
    )
    multipliers, shapes = (
        draw([branch], "the case").axes[0] for draw in (branch_figures.multiplier_figure, branch_figures.shape_figure)
    )
    assert multipliers.get_title() == shapes.get_title() == "mode 2: state 3, energy 1"
    motion = branch_figures.motion_figure(
        [branch], (units.Label("displacement"), units.Label("time")), "the case"
    ).axes[0]
    ticks = np.concatenate([axis.get_xticks() for axis in (shapes, motion)])
    assert np.array_equal(ticks, ticks.round())  # numbers of beads
    looks = {line.get_label(): (line.get_marker(), line.get_linestyle()) for line in shapes.get_lines()}
    assert looks["last state"] == ("o", "None")
    assert looks["linear mode"] == ("None", "-")
