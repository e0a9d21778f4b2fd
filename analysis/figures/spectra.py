"""Spectra of the velocities of beads."""

import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import (
    axis_unit,
    draw_chains,
    finish,
    new_figure,
    shown_chains,
    styled,
)
from analysis.gauges.spectra import SpectrumTable, VelocitySpectra
from lammps_inputs import Problem

MOST_BEADS = 8

DEEPEST = 1e-8
"""Lower end of the axis of amplitudes, over the largest; what is smaller lies below the axis."""


@styled
def spectra_figure(problem: Problem, spectra: VelocitySpectra) -> Figure:
    """One panel a bead (the first eight), a line for each chain that other figures show too; frequencies of drives."""
    velocity = axis_unit(problem, "velocity", float(np.max(spectra.amplitude)))
    frequency = axis_unit(problem, "cycles", float(np.max(spectra.frequency)))
    count, chains = min(len(spectra.beads), MOST_BEADS), shown_chains(problem)
    top = float(np.max(spectra.amplitude, initial=1e-30)) * velocity.worth
    figure = new_figure(max(2.8, 1.0 + 1.6 * count))
    axes = np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=True))
    axes[0].set_ylim(DEEPEST * top, 2.0 * top)  # before the scale is logarithmic: a bead may be at rest
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
