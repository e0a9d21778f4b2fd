"""Power over wavenumber and frequency with the exact branches of the chain."""

import math

import numpy as np

from granchain.parts import Problem, panels, units
from workflow.plugins.sound.dispersion import Branches, Map

_PI, _MINUS = "\N{GREEK SMALL LETTER PI}", "\N{MINUS SIGN}"

TICKS = {-math.pi: f"{_MINUS}{_PI}", -math.pi / 2: f"{_MINUS}{_PI}/2", 0.0: "0", math.pi / 2: f"{_PI}/2", math.pi: _PI}
"""Wavenumbers that the axis names."""


def dispersion_sheet(problem: Problem, spectrum: Map) -> panels.Sheet:
    """The map of the chain with the largest excitation; exact branches as lines, borders of the bands dotted."""
    edges = spectrum.cell.bands()
    unit = panels.axis_unit(problem, "frequency", float(edges.max()))
    power, across, (bottom, top) = spectrum.shown_power()
    up = (bottom * unit.worth, top * unit.worth)
    label = units.Label("$\\log_{10}$ (power / maximum)")
    image = panels.Image(power, across, up, label, (-spectrum.DECADES, 0.0))
    q = np.linspace(-math.pi, math.pi, 401)
    branches = np.pad(spectrum.cell.branches(q).T * unit.worth, ((0, 0), (0, 1)), constant_values=np.nan)
    dashes = {"color": "white", "linestyle": "--", "linewidth": 0.9}
    lines = panels.Curve("exact branches", np.tile(np.append(q, np.nan), len(branches)), branches.ravel(), look=dashes)
    dots = {"color": "0.55", "linestyle": ":", "linewidth": 1.0}
    borders = panels.Marks(np.unique((edges * unit.worth).round(12)), "edges of bands", dots, level=True)
    wavenumber = panels.AxisUnit(1.0, "rad/bead").axis(Branches, "wavenumber", ends=(-math.pi, math.pi), ticks=TICKS)
    frequency = unit.axis(Branches, "frequency", "angular frequency", ends=(0.0, spectrum.top * unit.worth))
    chain = f"chain {spectrum.chain}" if problem.chains > 1 else ""
    panel = panels.Panel(wavenumber, frequency, (lines,), chain, marks=(borders,), image=image)
    return panels.Sheet(panels.title(problem), [[panel]], 4.8, 6.4)
