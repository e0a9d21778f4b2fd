"""Power over wavenumber and frequency, with the exact branches of the loaded chain on it."""

import math

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.dispersion import Branches, Map
from analysis.figures.style import STYLE, Unit, axis_unit, title
from lammps_inputs import Problem

DECADES = 8.0
"""Of power that are shown."""

HIGHEST = 1.25
"""Largest frequency shown, over the highest of the exact branches."""


@mpl.rc_context(STYLE)
def dispersion_figure(problem: Problem, found: Map) -> Figure:
    """The map of the chain with the largest excitation; branches as lines, borders of the bands dotted."""
    edges = found.cell.bands()
    unit = axis_unit(problem, "frequency", float(edges.max()))
    worth = unit.worth
    bands = edges * worth
    shown = found.frequency * worth <= HIGHEST * bands.max()
    step = found.wavenumber[1] - found.wavenumber[0]
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    axis = figure.subplots()
    image = axis.imshow(
        np.log10(np.maximum(found.power[shown], 10.0**-DECADES)),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        extent=(
            found.wavenumber[0] - 0.5 * step,
            found.wavenumber[-1] + 0.5 * step,
            -0.5 * found.bin * worth,
            (found.frequency[shown][-1] + 0.5 * found.bin) * worth,
        ),
        cmap="magma",
        vmin=-DECADES,
        vmax=0.0,
        rasterized=True,
    )
    q = np.linspace(-math.pi, math.pi, 401)
    axis.plot(q, found.cell.branches(q) * worth, color="white", linestyle="--", linewidth=0.9)
    for edge in np.unique(bands.round(12)):
        axis.axhline(edge, color="0.7", linestyle=":", linewidth=0.8)
    axis.set_xlim(-math.pi, math.pi)
    axis.set_ylim(0.0, min(HIGHEST * bands.max(), float(found.frequency[-1]) * worth))
    axis.set_xticks(
        [-math.pi, -math.pi / 2, 0.0, math.pi / 2, math.pi], [r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"]
    )
    axis.set_xlabel(Unit(1.0, "rad/bead").label(Branches, "wavenumber"))
    axis.set_ylabel(unit.label(Branches, "frequency", "angular frequency"))
    bar = figure.colorbar(image, ax=axis)
    bar.set_label(r"$\log_{10}$ (power / maximum)")
    figure.suptitle(f"{title(problem)}; chain {found.chain}")
    return figure
