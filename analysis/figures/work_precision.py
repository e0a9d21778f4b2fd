"""The figure of error against cost: a line for each method, the Pareto front, and uncertainty of the reference."""

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from analysis.figures.style import CHAIN_COLOURS, STYLE, letter, title
from analysis.trajectory import Floats
from lammps_inputs import Problem

MARKERS = "osD^v<>Px*h"

UNITS = {"velocity": "V", "amplitude": "V", "arrival": "T"}

LEAST = 1e-14
"""Errors below this are drawn here; there are no logarithms of 0."""

COLOURS = (*CHAIN_COLOURS, "0.55")


Curve = Sequence[Mapping[str, float]]
"""One method: a mapping for each setting, with the errors ``velocity_error`` etc., the median and the range of the wall
time (``seconds``, ``seconds_min``, ``seconds_max``) and ``forces``, a number of evaluations."""


@mpl.rc_context(STYLE)
def work_precision_figure(
    problem: Problem, curves: Mapping[str, Curve], fronts: Mapping[str, Floats], floors: Mapping[str, float]
) -> Figure:
    """Errors of velocity, amplitude and arrival over wall time, and of velocity over force evaluations.

    Args:
        problem: what was computed.
        curves: all methods by name.
        fronts: by quantity, the Pareto front over wall time as rows of (seconds, error).
        floors: by quantity, the error of the reference.
    """
    figure = Figure(figsize=(9.5, 7.6), layout="constrained")
    (velocity, forces), (amplitude, arrival) = figure.subplots(2, 2)
    for axis, quantity in ((velocity, "velocity"), (amplitude, "amplitude"), (arrival, "arrival")):
        _draw_front(axis, fronts[quantity])
        for number, (name, curve) in enumerate(curves.items()):
            _draw(axis, number, name, curve, (f"{quantity}_error", "seconds"))
            _draw_spread(axis, number, curve, quantity)
        axis.set_xlabel("wall time with frames (s)")
        _finish(axis, quantity, floors[quantity])
    for number, (name, curve) in enumerate(curves.items()):
        _draw(forces, number, name, curve, ("velocity_error", "forces"))
    forces.set_xlabel("force evaluations")
    _finish(forces, "velocity", floors["velocity"])
    handles, labels = velocity.get_legend_handles_labels()
    letter(figure.axes)
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    figure.suptitle(title(problem))
    return figure


def _colour(number: int) -> str:
    return COLOURS[number % len(COLOURS)]


def _column(curve: Curve, name: str) -> Floats:
    values = np.array([one[name] for one in curve], dtype=np.float64)
    return np.maximum(values, LEAST) if name.endswith("error") else values


def _draw(axis: Axes, number: int, name: str, curve: Curve, columns: tuple[str, str]) -> None:
    """A method's error over a cost; settings whose error is infinite are left out."""
    error, cost = (_column(curve, column) for column in columns)
    shown = np.isfinite(error)
    if shown.any():
        axis.plot(
            cost[shown],
            error[shown],
            color=_colour(number),
            marker=MARKERS[number % len(MARKERS)],
            markersize=4,
            linestyle="-" if number < len(COLOURS) else "--",
            linewidth=1.0,
            label=name,
        )


def _draw_spread(axis: Axes, number: int, curve: Curve, quantity: str) -> None:
    """Ranges of the wall time."""
    columns = (f"{quantity}_error", "seconds", "seconds_min", "seconds_max")
    error, seconds, low, high = (_column(curve, column) for column in columns)
    shown = np.isfinite(error)
    spread = np.abs([seconds - low, high - seconds])[:, shown]
    axis.errorbar(seconds[shown], error[shown], xerr=spread, fmt="none", ecolor=_colour(number), elinewidth=0.7)


def _draw_front(axis: Axes, front: Floats) -> None:
    if len(front):
        x, y = front.T
        y = np.maximum(y, LEAST)
        axis.step(x, y, where="post", color="0.82", linewidth=7.0, solid_capstyle="round", label="Pareto front")


def _finish(axis: Axes, quantity: str, floor: float) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.axhline(
        max(floor, LEAST), color="black", linewidth=0.8, linestyle=(0, (2, 2)), label="uncertainty of the reference"
    )
    axis.set_ylabel(f"largest error of {quantity} / ${UNITS[quantity]}$")
    for setting in (axis.xaxis, axis.yaxis):
        _label_sparsely(setting)
    axis.grid(True, which="major", color="0.93", linewidth=0.6)
    axis.set_axisbelow(True)


def _label_sparsely(setting: XAxis | YAxis) -> None:
    """Powers of ten, at most six; where there is hardly more than one, 2 and 5 times it as short numbers."""
    low, high = setting.get_view_interval()
    setting.set_major_locator(LogLocator(numticks=6))
    if high > 30.0 * low:
        setting.set_minor_formatter(NullFormatter())
        return
    setting.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    for of in (setting.set_major_formatter, setting.set_minor_formatter):
        of(FuncFormatter(lambda value, _: f"{value:.3g}"))
