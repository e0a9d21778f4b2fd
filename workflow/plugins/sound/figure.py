"""Power over wavenumber and frequency with the exact branches of the chain."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granchain.parts import Problem, style
from workflow.plugins.sound.dispersion import Branches, Map


@style.styled
def dispersion_figure(problem: Problem, spectrum: Map) -> Figure:
    """The map of the chain with the largest excitation; exact branches as lines, borders of the bands dotted."""
    edges = spectrum.cell.bands()
    unit = style.axis_unit(problem, "frequency", float(edges.max()))
    worth = unit.worth
    bands = edges * worth
    power, (left, right), (bottom, top) = spectrum.shown_power()
    figure = style.new_figure(4.8, 6.4)
    axis = figure.subplots()
    image = axis.imshow(
        power,
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        extent=(left, right, bottom * worth, top * worth),
        cmap="magma",
        vmin=-spectrum.DECADES,
        vmax=0.0,
        rasterized=True,
    )
    q = np.linspace(-math.pi, math.pi, 401)
    dashes: Any = {"linestyle": "--", "linewidth": 0.9}
    dots: Any = {"linestyle": ":", "linewidth": 1.0}
    for look in ({"color": "black", "linewidth": 2.4}, {"color": "white", **dashes}):  # seen on all colours of the map
        axis.plot(q, spectrum.cell.branches(q) * worth, **look)
    for edge in np.unique(bands.round(12)):
        axis.axhline(edge, color="0.7", **dots)
    axis.set_xlim(-math.pi, math.pi)
    axis.set_ylim(0.0, spectrum.top * worth)
    axis.set_xticks(
        [-math.pi, -math.pi / 2, 0.0, math.pi / 2, math.pi], [r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"]
    )
    axis.set_xlabel(style.AxisUnit(1.0, "rad/bead").label(Branches, "wavenumber"))
    axis.set_ylabel(unit.label(Branches, "frequency", "angular frequency"))
    bar = figure.colorbar(image, ax=axis)
    bar.set_label(r"$\log_{10}$ (power / maximum)")
    chain = f"; chain {spectrum.chain}" if problem.chains > 1 else ""
    style.head(figure, f"{style.title(problem)}{chain}")
    # white on the map
    style.legend_below(
        figure,
        [Line2D([], [], color="black", **dashes), Line2D([], [], color="0.4", **dots)],
        ["exact branches", "edges of bands"],
    )
    return figure
