"""Spectra of beads' velocities."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import STYLE, axis_unit, chain_legend, draw_chain, shown_chains, title
from analysis.gauges.spectra import Spectra
from lammps_inputs import Problem

MOST_BEADS = 8

DEEPEST = 1e-8
"""Smallest amplitude that is drawn, over the largest."""


def spectra_figure(problem: Problem, spectra: Spectra) -> Figure:
    """One panel a bead (the first eight), a line for each chain that other figures show too; drives are dotted."""
    velocity = axis_unit(problem, "velocity", float(np.max(spectra.amplitude)))
    unit = problem.scale.symbol("cycles")
    worth = 1.0 / problem.scale.time
    count = min(len(spectra.beads), MOST_BEADS)
    top = float(np.max(spectra.amplitude, initial=1e-30)) * velocity.worth
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 1.2 + 1.6 * count), layout="constrained")
        axes = np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=True))
        for place, axis in enumerate(axes):
            for frequency in spectra.drive:
                axis.axvline(frequency * worth, color="0.5", linewidth=0.8, linestyle=":")
            for position, chain in enumerate(shown_chains(problem)):
                height = np.maximum(spectra.amplitude[:, chain, place] * velocity.worth, DEEPEST * top)
                draw_chain(axis, position, chain, spectra.frequency * worth, height)
            axis.set_yscale("log")
            axis.set_ylabel(f"bead {spectra.beads[place]}\n({velocity.symbol})")
        axes[0].set_ylim(DEEPEST * top, 2.0 * top)
        axes[-1].set_xlabel(f"frequency ({unit})")
        figure.suptitle(title(problem, each_chain=True, until=problem.duration))
        chain_legend(figure, axes[0])
    return figure
