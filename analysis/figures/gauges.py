"""What gauges read: force over time at walls, contacts and sensors; spectra of beads' velocities."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import STYLE, axis_unit, chain_legend, draw_chain, letter, shown_chains, title
from analysis.gauges.forces import ForceTable, Readings
from analysis.gauges.spectra import Spectra, SpectrumTable
from lammps_inputs import Problem

MOST_GAUGES = 8


@mpl.rc_context(STYLE)
def force_figure(problem: Problem, readings: Readings) -> Figure:
    """One panel a gauge (the first eight), a line for each chain that other figures show too."""
    time = axis_unit(problem, "time", float(readings.time[-1]))
    force = axis_unit(problem, "force", float(np.max(readings.largest)))
    count = min(len(readings.gauges), MOST_GAUGES)
    figure = Figure(figsize=(7.0, 1.2 + 1.6 * count), layout="constrained")
    axes = np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=True))
    for place, axis in enumerate(axes):
        for position, chain in enumerate(shown_chains(problem)):
            draw_chain(axis, position, chain, readings.time * time.worth, readings.force[:, chain, place] * force.worth)
        axis.set_ylabel(f"{'total ' if readings.loaded else ''}{force.label(ForceTable, 'force')}")
        largest = f"largest {float(np.max(readings.largest[:, place])) * force.worth:.4g}"
        if readings.loaded:
            dynamic = float(np.fmax.reduce(readings.dynamic[:, place])) * force.worth
            largest += f", dynamic {dynamic:.4g}" if np.isfinite(dynamic) else ", never above the static force"
        axis.set_title(readings.gauges[place].name, loc="left")
        axis.set_title(largest, loc="right", fontsize=8, color="0.3")
    letter(axes)
    axes[-1].set_xlabel(time.label(ForceTable, "time"))
    left_out = len(readings.gauges) - count
    more = f"; {left_out} more gauges are in forces.csv" if left_out else ""
    figure.suptitle(title(problem, each_chain=True, until=float(readings.time[-1])) + more)
    chain_legend(figure, axes[0])
    return figure


MOST_BEADS = 8

DEEPEST = 1e-8
"""Smallest amplitude that is drawn, over the largest."""


@mpl.rc_context(STYLE)
def spectra_figure(problem: Problem, spectra: Spectra) -> Figure:
    """One panel a bead (the first eight), a line for each chain that other figures show too; drives are dotted."""
    velocity = axis_unit(problem, "velocity", float(np.max(spectra.amplitude)))
    frequency = axis_unit(problem, "cycles", float(np.max(spectra.frequency)))
    count = min(len(spectra.beads), MOST_BEADS)
    top = float(np.max(spectra.amplitude, initial=1e-30)) * velocity.worth
    figure = Figure(figsize=(7.0, 1.2 + 1.6 * count), layout="constrained")
    axes = np.atleast_1d(figure.subplots(count, 1, sharex=True, sharey=True))
    for place, axis in enumerate(axes):
        for drive in spectra.drive:
            axis.axvline(drive * frequency.worth, color="0.5", linewidth=0.8, linestyle=":")
        for position, chain in enumerate(shown_chains(problem)):
            height = np.maximum(spectra.amplitude[:, chain, place] * velocity.worth, DEEPEST * top)
            draw_chain(axis, position, chain, spectra.frequency * frequency.worth, height)
        axis.set_yscale("log")
        axis.set_title(f"bead {spectra.beads[place]}", loc="left")
    letter(axes)
    figure.supylabel(velocity.label(SpectrumTable, "amplitude", "amplitude of the velocity"), fontsize="medium")
    axes[0].set_ylim(DEEPEST * top, 2.0 * top)
    axes[-1].set_xlabel(frequency.label(SpectrumTable, "frequency"))
    figure.suptitle(title(problem, each_chain=True, until=problem.duration))
    chain_legend(figure, axes[0])
    return figure
