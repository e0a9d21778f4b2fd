"""What gauges read: force over time at walls, contacts and sensors; spectra of beads' velocities."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import STYLE, Unit, axis_unit, chain_legend, draw_chain, letter, shown_chains, title
from analysis.figures.waves import after_peak, peak_title, pulses
from analysis.gauges.forces import ForceTable, Readings
from analysis.gauges.spectra import Spectra, SpectrumTable
from analysis.trajectory import Flags, Floats
from lammps_inputs import Problem

MOST_GAUGES = 8


@mpl.rc_context(STYLE)
def force_figure(problem: Problem, readings: Readings) -> Figure:
    """One row a gauge (the first eight), a line for each chain that other figures show too.

    Left over the whole run, right the passages of its largest pulses, their time from the peak.
    """
    time = axis_unit(problem, "time", float(readings.time[-1]))
    force = axis_unit(problem, "force", float(np.max(readings.largest)))
    count = min(len(readings.gauges), MOST_GAUGES)
    size = np.max(np.abs(readings.force - readings.static), axis=1)  # [frame, gauge]
    spans = [pulses(readings.time, size[:, place]) for place in range(count)]
    more = max(map(len, spans))
    figure = Figure(figsize=(7.0 + 1.5 * max(0, more - 1), 1.2 + 1.6 * count), layout="constrained")
    axes, *close = figure.subplots(
        count, 1 + more, sharex="col", sharey=True, squeeze=False, width_ratios=(2.5, *[1.0] * more)
    ).T  # fmt: skip
    near = max((high - low for gauge in spans for _, low, high in gauge), default=1.0)
    unit = axis_unit(problem, "time", near)
    for place, axis in enumerate(axes):
        _draw(axis, problem, readings, place, readings.time * time.worth, force)
        for column, (peak, low, high) in zip(close, spans[place], strict=False):
            inside = (readings.time >= low) & (readings.time <= high)
            _draw(column[place], problem, readings, place, (readings.time - peak) * unit.worth, force, inside)
            column[place].set_title(peak_title(problem, peak, time), loc="left")
        for column in close[len(spans[place]) :]:
            column[place].remove()
        axis.set_ylabel(f"{'total ' if readings.loaded else ''}{force.label(ForceTable, 'force')}")
        largest = f"largest {float(np.max(readings.largest[:, place])) * force.worth:.4g}"
        if readings.loaded:
            dynamic = float(np.fmax.reduce(readings.dynamic[:, place])) * force.worth
            largest += f", dynamic {dynamic:.4g}" if np.isfinite(dynamic) else ", never above the static force"
        axis.set_title(readings.gauges[place].name, loc="left")
        axis.set_title(largest, loc="right", fontsize=8, color="0.3")
    letter(figure.axes)
    for label, column in [(time.label(ForceTable, "time"), axes), *((after_peak(unit), column) for column in close)]:
        lowest = [axis for axis in column if axis in figure.axes][-1]
        lowest.set_xlabel(label)
        lowest.xaxis.set_tick_params(labelbottom=True)
    left_out = len(readings.gauges) - count
    rest = f"; {left_out} more gauges are in forces.csv" if left_out else ""
    figure.suptitle(title(problem, each_chain=True, until=float(readings.time[-1])) + rest)
    chain_legend(figure, axes[0])
    return figure


def _draw(
    axis: Axes, problem: Problem, readings: Readings, place: int, x: Floats, unit: Unit, inside: Flags | None = None
) -> None:
    chosen = slice(None) if inside is None else inside
    for position, chain in enumerate(shown_chains(problem)):
        draw_chain(axis, position, chain, x[chosen], readings.force[chosen, chain, place] * unit.worth)


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
