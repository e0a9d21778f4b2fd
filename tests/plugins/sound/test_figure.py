"""Where power and branches are in the figure of the dispersion: numbers made by hand."""

import math

import numpy as np
from figure_table import assert_shown, at_both_widths
from stock_lammps import scene

from analysis.figures.drawing import draw
from analysis.shape.unit_cell import UnitCell
from lammps_inputs import Kick, Material
from workflow.plugins.sound.dispersion import Map
from workflow.plugins.sound.figure import dispersion_sheet

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


def drawn():
    """Chain 7 of 12: power at q = pi / 2 and the frequency 2, and a branch of omega = 3 |sin(q / 2)|."""
    problem = scene(chains=12, beads=10, kick=(Kick(chain=6, velocity=0.01),), material=STEEL).problem()
    cell = UnitCell(np.array([[1.0]]), np.array([[2.25]]), np.zeros((1, 1, 1)))
    power, nothing = np.zeros((8, 8)), np.zeros((1, 1))
    power[4, 6] = 1.0
    wavenumber = np.arange(-4, 4) * math.pi / 4.0
    found = Map(7, wavenumber, 0.5 * np.arange(8), power, cell, nothing[0], nothing, nothing)
    return draw(dispersion_sheet(problem, found))


@at_both_widths
def test_the_dispersion_figure_has_power_and_branches_where_its_axes_say(width, golden):
    assert_shown("dispersion-si", drawn, width, golden)
