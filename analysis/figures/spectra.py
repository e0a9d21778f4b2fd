"""Spectra: of the velocities of beads, and power over wavenumber and frequency with the exact branches of the chain."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.dispersion import Branches, Map
from analysis.figures.style import (
    AxisUnit,
    axis_unit,
    draw_chains,
    finish,
    head,
    legend_below,
    new_figure,
    shown_chains,
    styled,
    title,
)
from analysis.gauges.spectra import SpectrumTable, VelocitySpectra
from lammps_inputs import Problem

MOST_BEADS = 8


@styled
def spectra_figure(problem: Problem, spectra: VelocitySpectra) -> Figure:
    """One panel a bead (the first eight), a line for each chain that other figures show too; frequencies of drives."""
    velocity = axis_unit(problem, "velocity", float(np.max(spectra.amplitude)))
    frequency = axis_unit(problem, "cycles", float(np.max(spectra.frequency)))
    count, chains = min(len(spectra.beads), MOST_BEADS), shown_chains(problem)
    top = float(np.max(spectra.amplitude, initial=1e-30)) * velocity.worth
    figure = new_figure(max(2.8, 1.0 + 1.6 * count))
    axes = np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=True))
    axes[0].set_ylim(spectra.DEEPEST * top, 2.0 * top)  # before the scale is logarithmic: a bead may be at rest
    for place, axis in enumerate(axes):
        height = spectra.amplitude[:, chains, place] * velocity.worth
        draw_chains(axis, chains, spectra.frequency * frequency.worth, height)
        axis.set_yscale("log")
        for number, drive in enumerate(spectra.drive):
            label = None if number else "drive"
            axis.axvline(drive * frequency.worth, color="0.4", linewidth=0.9, linestyle=":", label=label)
        axis.set_title(f"bead {spectra.beads[place]}", loc="left")
    figure.supylabel(velocity.label(SpectrumTable, "amplitude", "amplitude of the velocity"), fontsize="medium")
    axes[-1].set_xlabel(frequency.label(SpectrumTable, "frequency"))
    finish(figure, problem, axes)
    return figure


@styled
def dispersion_figure(problem: Problem, spectrum: Map) -> Figure:
    """The map of the chain with the largest excitation; exact branches as lines, borders of the bands dotted."""
    edges = spectrum.cell.bands()
    unit = axis_unit(problem, "frequency", float(edges.max()))
    worth = unit.worth
    bands = edges * worth
    power, (left, right), (bottom, top) = spectrum.shown_power()
    figure = new_figure(4.8, 6.4)
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
    axis.set_xlabel(AxisUnit(1.0, "rad/bead").label(Branches, "wavenumber"))
    axis.set_ylabel(unit.label(Branches, "frequency", "angular frequency"))
    bar = figure.colorbar(image, ax=axis)
    bar.set_label(r"$\log_{10}$ (power / maximum)")
    chain = f"; chain {spectrum.chain}" if problem.chains > 1 else ""
    head(figure, f"{title(problem)}{chain}")
    # white on the map
    legend_below(
        figure,
        [Line2D([], [], color="black", **dashes), Line2D([], [], color="0.4", **dots)],
        ["exact branches", "edges of bands"],
    )
    return figure
