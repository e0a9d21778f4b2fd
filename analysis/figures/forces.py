"""Forces: over time at walls, contacts and sensors, and the largest ones of contacts that yield along the chains."""

import numpy as np
from matplotlib.figure import Figure

from analysis.contacts import YieldTable, power_law
from analysis.figures.style import (
    axis_unit,
    draw_chain,
    draw_chains,
    finish,
    is_narrow,
    label_log_axis,
    new_figure,
    shown_chains,
    styled,
)
from analysis.figures.waves import pulses, time_title
from analysis.gauges.forces import ForceTable, Readings
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics

MOST_GAUGES = 8


@styled
def force_figure(problem: Problem, readings: Readings) -> Figure:
    """One row a gauge (the first eight), a line for each chain that other figures show too.

    Left over the whole run, right the passages of its largest pulses, in a narrow figure of the first, their time from
    the peak.
    """
    time = axis_unit(problem, "time", float(readings.time[-1]))
    force = axis_unit(problem, "force", float(np.max(readings.force)))
    count, chains = min(len(readings.gauges), MOST_GAUGES), shown_chains(problem)
    size = np.max(np.abs(readings.force - readings.static), axis=1)  # [frame, gauge]
    spans = [pulses(readings.time, size[:, place]) for place in range(count)]
    spans = [gauge[:1] for gauge in spans] if is_narrow() else spans
    more = max(map(len, spans))
    figure = new_figure(1.2 + 1.6 * count, 7.0 + 1.5 * max(0, more - 1))
    ratio = 1.5 if is_narrow() else 2.5
    axes, *close = figure.subplots(
        count, 1 + more, sharex="col", sharey=True, squeeze=False, width_ratios=(ratio, *[1.0] * more)
    ).T  # fmt: skip
    near = max((high - low for gauge in spans for _, low, high in gauge), default=1.0)
    unit = axis_unit(problem, "time", near)
    for place, axis in enumerate(axes):
        curves = readings.force[:, chains, place] * force.worth
        draw_chains(axis, chains, readings.time * time.worth, curves)
        for column, (peak, low, high) in zip(close, spans[place], strict=False):
            inside = (readings.time >= low) & (readings.time <= high)
            draw_chains(column[place], chains, (readings.time[inside] - peak) * unit.worth, curves[inside])
            column[place].set_title(time_title(problem, "peak", peak, time), loc="left")
        for column in close[len(spans[place]) :]:
            column[place].remove()
        largest = f"largest {float(np.max(readings.largest[:, place])) * force.worth:.4g}"
        if np.isnan(readings.largest[:, place]).any():
            largest = "largest unknown between frames"
        elif readings.loaded:
            dynamic = float(np.fmax.reduce(readings.dynamic[:, place])) * force.worth
            largest += f", dynamic {dynamic:.4g}" if np.isfinite(dynamic) else ", never above the static force"
        axis.set_title(readings.gauges[place].name, loc="left")
        if not is_narrow():
            axis.set_title(largest, loc="right", fontsize="small", color="0.3")
    figure.supylabel(f"{'total ' if readings.loaded else ''}{force.label(ForceTable, 'force')}", fontsize="medium")
    for label, column in [
        (time.label(ForceTable, "time"), axes),
        *((f"time after peak\n({unit.symbol})", column) for column in close),
    ]:
        lowest = [axis for axis in column if axis in figure.axes][-1]
        lowest.set_xlabel(label)
        lowest.xaxis.set_tick_params(labelbottom=True)
    left_out = len(readings.gauges) - count
    rest = f"; {left_out} more gauges are in forces.csv" if left_out else ""
    finish(figure, problem, figure.axes, until=float(readings.time[-1]), note=rest)
    return figure


LEAST = 1e-4
"""Share of the largest value below which none is drawn."""


@styled
def yield_figure(problem: Problem, table: YieldTable) -> Figure:
    """Largest force and permanent overlap over the number of the contact, on logarithmic axes.

    Contacts that have not begun to open are left out: their numbers are those of the end of the record. The power law
    of `analysis.contacts.Yielded` is drawn over the contacts that it was fitted to.
    """
    final = table.opened == 1
    force, length = (axis_unit(problem, kind, _most(values[final])) for kind, values in _yielded(table))
    figure = new_figure(5.6)
    axes = figure.subplots(2, 1, sharex=True)
    for position, chain in enumerate(shown_chains(problem)):
        of_chain = (table.chain == chain + 1) & final
        for axis, unit, (_, values) in zip(axes, (force, length), _yielded(table), strict=True):
            noticed = values[of_chain] > LEAST * _most(values[final])
            shown = np.where(noticed, values[of_chain] * unit.worth, np.nan)
            draw_chain(axis, position, chain, table.contact[of_chain], shown)
    kicked = table.chain == physics.largest_excitation(problem.system)[0]
    law = power_law(table.force[kicked], table.opened[kicked] == 1)
    if law is not None:
        fitted = law.factor * law.contact**law.exponent * force.worth
        look = {"color": "black", "linestyle": (0, (1, 1)), "linewidth": 2.0}
        axes[0].plot(law.contact, fitted, label=rf"$\propto n^{{{law.exponent:.3f}}}$", **look)
    axes[0].set_ylabel(force.label(YieldTable, "force", "largest force"))
    axes[1].set_ylabel(length.label(YieldTable, "permanent", "permanent overlap"))
    axes[1].set_xlabel("contact $n$")
    for axis in axes:
        axis.set_xscale("log")
        axis.set_yscale("log")
    for setting in (axes[1].xaxis, axes[0].yaxis, axes[1].yaxis):
        label_log_axis(setting)
    finish(figure, problem, axes)
    return figure


def _yielded(table: YieldTable) -> tuple[tuple[str, Floats], tuple[str, Floats]]:
    """Kinds of unit and values that are drawn, [contact]."""
    return ("force", table.force), ("length", table.permanent)


def _most(values: Floats) -> float:
    return float(np.max(values, initial=0.0)) or 1.0
