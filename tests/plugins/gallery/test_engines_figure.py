"""Figures of rigid and elastic beads: numbers made by hand."""

import numpy as np
import pytest
from axis_units import unit_on
from stock_lammps import scene

from lammps_inputs import Kick, Material
from workflow.plugins.gallery.engines_figure import (
    EngineCurve,
    PublishedPoint,
    engines_figure,
    relative_mode_figure,
    scan_figure,
)

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)
SPEED = 3.0


def test_a_scan_has_a_panel_for_each_row_that_it_names_with_the_published_point():
    point = PublishedPoint("gap of eq. 5", 0.15, np.array([0.55, 0.75]))
    theta, differences = np.array([0.1, 0.2]), np.array([[0.5, 0.7], [0.6, 0.0]])
    axes = scan_figure(theta, differences, (10, 55), 0.01, point).axes
    found = {axis.get_title(loc="left"): {line.get_label(): line for line in axis.get_lines()} for axis in axes}
    assert found["(a) row 10"]["rigid beads"].get_ydata().tolist() == [0.5, 0.6]
    np.testing.assert_array_equal(found["(b) row 55"]["rigid beads"].get_ydata(), [0.7, np.nan])  # 0 has no logarithm
    assert found["(b) row 55"]["gap of eq. 5"].get_xydata().tolist() == [[0.15, 0.75]]
    assert set(found["(a) row 10"]["1 %"].get_ydata()) == {0.01}


def test_a_difference_of_0_leaves_a_gap_in_the_relative_mode():
    (axis,) = relative_mode_figure([("rigid", np.arange(4), np.array([0.5, 0.0, -0.1, 1e-9]))]).axes
    np.testing.assert_array_equal(axis.get_lines()[0].get_ydata(), [0.5, np.nan, 0.1, np.nan])


@pytest.mark.parametrize("si", [False, True])
def test_the_engines_figure_has_each_bead_and_engine_where_it_says(si):
    keys = {"chains": 2, "beads": 10, "kick": (Kick(velocity=SPEED),), "material": STEEL if si else None}
    scale = scene(**keys).scale
    what = scene(**keys, gap=0.5 * scale.length, duration=4.0 * scale.time, every=0.5 * scale.time).problem()
    time, velocity = np.array([0.0, 1.0, 2.0]), np.zeros((3, 2, 2))
    velocity[1, 1, 1] = 0.5  # chain 2, the second of the rows shown
    curve = EngineCurve("rigid", time, velocity, np.array([2, 3]), np.array([[0.7, 0.6], [0.2, 0.1]]))
    first, *rows = engines_figure(what, (4, 9), [curve]).axes
    assert [axis.get_title(loc="left") for axis in (first, *rows)] == ["(a) rigid", "(b) bead 4", "(c) bead 9"]
    assert first.get_ylabel() == "first impulse $I / (m V)$"
    assert [line.get_ydata().tolist() for line in first.get_lines()] == [[0.7, 0.6], [0.2, 0.1]]
    assert not np.any([line.get_ydata() for line in rows[0].get_lines()])
    moved = rows[1].get_lines()[1]
    assert moved.get_ydata() * unit_on(rows[1].get_ylabel(), what, "m/s") == pytest.approx([0.0, 0.5 * SPEED, 0.0])
    assert moved.get_xdata() * unit_on(rows[1].get_xlabel(), what, "s") == pytest.approx(time * what.scale.time)
