"""Figure of errors over cost: every method, the Pareto fronts, and the uncertainty of the reference."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granchain.parts import Floats, Problem, panels, style

MARKERS = "osD^v<>Px*h"

UNITS = {"velocity": "V", "amplitude": "V", "arrival": "T"}

LEAST = 1e-14
"""Errors below this are drawn here; there are no logarithms of 0."""

COLOURS = (*style.CHAIN_COLOURS, "0.55")


Curve = Sequence[Mapping[str, float]]
"""One method: a mapping for each setting, with the errors ``velocity_error`` etc., the median and the range of the wall
time (``seconds``, ``seconds_min``, ``seconds_max``) and ``forces``, a number of evaluations."""


@style.styled
def work_precision_figure(
    problem: Problem, curves: Mapping[str, Curve], fronts: Mapping[str, Floats], floors: Mapping[str, float]
) -> Figure:
    """Errors of velocity, amplitude and arrival over wall time, and of velocity over force evaluations.

    Args:
        problem: what was computed.
        curves: all methods by name.
        fronts: by quantity, the Pareto front over wall time, [point, 2]: seconds and error.
        floors: by quantity, the uncertainty of the reference (in V or T).
    """
    figure = style.new_figure(7.6, 9.5)
    (velocity, forces), (amplitude, arrival) = figure.subplots(2, 2)
    for axis, quantity in ((velocity, "velocity"), (amplitude, "amplitude"), (arrival, "arrival")):
        _draw_front(axis, fronts[quantity])
        for number, (name, curve) in enumerate(curves.items()):
            _draw(axis, number, name, curve, (f"{quantity}_error", "seconds"), spread=True)
        axis.set_xlabel("wall time\nwith frames (s)" if style.is_narrow() else "wall time with frames (s)")
        _finish(axis, quantity, floors[quantity])
    for number, (name, curve) in enumerate(curves.items()):
        _draw(forces, number, name, curve, ("velocity_error", "forces"))
    forces.set_xlabel("force evaluations")
    _finish(forces, "velocity", floors["velocity"])
    handles, labels = velocity.get_legend_handles_labels()
    style.letter(figure.axes)
    style.legend_below(figure, handles, labels)
    style.head(figure, panels.title(problem))
    return figure


def _column(curve: Curve, name: str) -> Floats:
    values = np.array([setting[name] for setting in curve], dtype=np.float64)
    return np.maximum(values, LEAST) if name.endswith("error") else values


def _draw(axis: Axes, number: int, name: str, curve: Curve, columns: tuple[str, str], *, spread: bool = False) -> None:
    """A method's error over a cost, with ranges of the wall time; settings whose error is infinite are left out."""
    error, cost = (_column(curve, column) for column in columns)
    shown = np.isfinite(error)
    colour = COLOURS[number % len(COLOURS)]
    if shown.any():
        axis.plot(
            cost[shown],
            error[shown],
            color=colour,
            marker=MARKERS[number % len(MARKERS)],
            markersize=4,
            linestyle="-" if number < len(COLOURS) else "--",
            linewidth=1.0,
            label=name,
        )
    if spread:
        ends = np.abs([_column(curve, f"seconds_{end}") - cost for end in ("min", "max")])[:, shown]
        axis.errorbar(cost[shown], error[shown], xerr=ends, fmt="none", ecolor=colour, elinewidth=0.7)


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
        style.label_log_axis(setting)
    axis.grid(True, which="major", color="0.93", linewidth=0.6)
    axis.set_axisbelow(True)
