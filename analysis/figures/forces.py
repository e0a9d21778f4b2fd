"""Forces: over time at walls, contacts and sensors, and the largest ones of contacts that yield along the chains."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.contacts import YieldTable
from analysis.figures.style import STYLE, axis_unit, draw_chain, draw_chains, finish, shown_chains
from analysis.figures.waves import after_peak, peak_title, pulses
from analysis.gauges.forces import ForceTable, Readings
from analysis.trajectory import Floats
from lammps_inputs import Problem

MOST_GAUGES = 8


@mpl.rc_context(STYLE)
def force_figure(problem: Problem, readings: Readings) -> Figure:
    """One row a gauge (the first eight), a line for each chain that other figures show too.

    Left over the whole run, right the passages of its largest pulses, their time from the peak.
    """
    time = axis_unit(problem, "time", float(readings.time[-1]))
    force = axis_unit(problem, "force", float(np.max(readings.force)))
    count, chains = min(len(readings.gauges), MOST_GAUGES), shown_chains(problem)
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
        curves = readings.force[:, chains, place] * force.worth
        draw_chains(axis, chains, readings.time * time.worth, curves)
        for column, (peak, low, high) in zip(close, spans[place], strict=False):
            inside = (readings.time >= low) & (readings.time <= high)
            draw_chains(column[place], chains, (readings.time[inside] - peak) * unit.worth, curves[inside])
            column[place].set_title(peak_title(problem, peak, time), loc="left")
        for column in close[len(spans[place]) :]:
            column[place].remove()
        axis.set_ylabel(f"{'total ' if readings.loaded else ''}{force.label(ForceTable, 'force')}")
        largest = f"largest {float(np.max(readings.largest[:, place])) * force.worth:.4g}"
        if np.isnan(readings.largest[:, place]).any():
            largest = "largest unknown between frames"
        elif readings.loaded:
            dynamic = float(np.fmax.reduce(readings.dynamic[:, place])) * force.worth
            largest += f", dynamic {dynamic:.4g}" if np.isfinite(dynamic) else ", never above the static force"
        axis.set_title(readings.gauges[place].name, loc="left")
        axis.set_title(largest, loc="right", fontsize=8, color="0.3")
    for label, column in [(time.label(ForceTable, "time"), axes), *((after_peak(unit), column) for column in close)]:
        lowest = [axis for axis in column if axis in figure.axes][-1]
        lowest.set_xlabel(label)
        lowest.xaxis.set_tick_params(labelbottom=True)
    left_out = len(readings.gauges) - count
    rest = f"; {left_out} more gauges are in forces.csv" if left_out else ""
    finish(figure, problem, figure.axes, until=float(readings.time[-1]), note=rest)
    return figure


LEAST = 1e-4
"""Share of the largest value below which none is drawn."""


@mpl.rc_context(STYLE)
def yield_figure(problem: Problem, table: YieldTable) -> Figure:
    """Over the number of the contact, on logarithmic axes."""
    force, length = (
        axis_unit(problem, "force", _most(table.force)),
        axis_unit(problem, "length", _most(table.permanent)),
    )
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    for position, chain in enumerate(shown_chains(problem)):
        here = table.chain == chain + 1
        for axis, unit, values in ((axes[0], force, table.force), (axes[1], length, table.permanent)):
            noticed = values[here] > LEAST * _most(values)
            shown = np.where(noticed, values[here] * unit.worth, np.nan)
            draw_chain(axis, position, chain, table.contact[here], shown)
    for axis, unit, name in ((axes[0], force, "force"), (axes[1], length, "permanent")):
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylabel(unit.label(YieldTable, name))
    axes[1].set_xlabel("contact")
    finish(figure, problem, axes)
    return figure


def _most(values: Floats) -> float:
    return float(np.max(values)) or 1.0
