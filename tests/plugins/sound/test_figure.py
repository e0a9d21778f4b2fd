"""Where power and branches are in the figure of the dispersion: numbers made by hand."""

import math
import re

import numpy as np
import pytest
from stock_lammps import scene

from analysis.figures.drawing import draw
from analysis.shape.unit_cell import UnitCell
from lammps_inputs import Kick, Material
from workflow.plugins.sound.dispersion import Map
from workflow.plugins.sound.figure import dispersion_sheet

STEEL = Material(radius=4.76e-3, density=8000.0, youngs_modulus=193e9, poisson_ratio=0.3)


@pytest.mark.parametrize("material", [None, STEEL], ids=["reduced", "SI"])
def test_the_dispersion_figure_has_power_and_branches_where_its_axes_say(material):
    problem = scene(chains=12, beads=10, kick=(Kick(chain=6, velocity=0.01),), material=material).problem()
    cell = UnitCell(np.array([[1.0]]), np.array([[2.25]]), np.zeros((1, 1, 1)))  # omega = 3 |sin(q / 2)|
    wavenumber = np.arange(-4, 4) * math.pi / 4.0
    frequency = 0.5 * np.arange(8)
    power = np.zeros((8, 8))
    power[4, 6] = 1.0
    nothing = np.zeros((1, 1))
    found = Map(7, wavenumber, frequency, power, cell, nothing[0], nothing, nothing)
    figure = draw(dispersion_sheet(problem, found))
    axis = figure.axes[0]
    (unit,) = re.findall(r"\(([^()]*)\)$", axis.get_ylabel())
    prefix = 1.0 if material is None else {"": 1.0, "k": 1e3, "M": 1e6}[unit.removesuffix("rad/s")]
    worth = 1.0 / problem.scale.time / prefix
    (image,) = axis.get_images()
    values, (left, right, bottom, top) = np.asarray(image.get_array()), image.get_extent()
    assert left < -math.pi < math.pi < right  # the edges of the zone are covered
    row, column = np.unravel_index(np.argmax(values), values.shape)
    assert left + (column + 0.5) * (right - left) / values.shape[1] == pytest.approx(wavenumber[6])
    assert bottom + (row + 0.5) * (top - bottom) / values.shape[0] == pytest.approx(frequency[4] * worth)
    q, branch = (values[:-1] for values in axis.get_lines()[0].get_data())  # the last point ends the branch
    assert np.asarray(branch) == pytest.approx(3.0 * worth * np.abs(np.sin(np.asarray(q) / 2.0)), abs=1e-9 * worth)
    assert axis.get_title(loc="left") == "chain 7"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["exact branches", "edges of bands"]
