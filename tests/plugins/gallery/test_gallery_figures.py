"""Figures of the gallery, as tables of what they show: numbers made by hand."""

import numpy as np
import pytest
from figure_table import assert_shown
from stock_lammps import scene

from lammps_inputs import Kick, Material
from workflow.plugins.gallery.engines_figure import (
    EngineCurve,
    PublishedPoint,
    engines_figure,
    relative_mode_figure,
    scan_figure,
)
from workflow.plugins.gallery.equipartition_distance import Distance, distance_map

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


def engines():
    """The second chain moves with 0.5 V at the second row that is shown, in the second of three instants."""
    keys = {"chains": 2, "beads": 10, "kick": (Kick(velocity=3.0),), "material": STEEL}
    scale = scene(**keys).scale
    problem = scene(**keys, gap=0.5 * scale.length, duration=4.0 * scale.time, every=0.5 * scale.time).problem()
    velocity = np.zeros((3, 2, 2))
    velocity[1, 1, 1] = 0.5
    impulses = np.array([[0.7, 0.6], [0.2, 0.1]])
    return engines_figure(problem, (4, 9), [EngineCurve("rigid", np.arange(3.0), velocity, np.array([2, 3]), impulses)])


def scan():
    """A difference of 0 has no logarithm."""
    point = PublishedPoint("gap of eq. 5", 0.15, np.array([0.55, 0.75]))
    return scan_figure(np.array([0.1, 0.2]), np.array([[0.5, 0.7], [0.6, 0.0]]), (10, 55), 0.01, point)


FIGURES = {
    "engines-si": engines,
    "scan": scan,
    "relative-mode": lambda: relative_mode_figure([("rigid", np.arange(4), np.array([0.5, 0.0, -0.1, 1e-9]))]),
    "distance-map": lambda: distance_map(
        [Distance(2, 0.2, 60, 20, 40, 0.34, 0.0), Distance(2, 0.1, 60, None, 60, 0.4, 0.0)]
    ),
}


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_of_the_gallery_has_each_number_where_its_table_says(name, golden):
    assert_shown(name, FIGURES[name], None, golden)
