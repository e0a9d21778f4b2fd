"""Figures of a search among designs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granchain.parts import Floats, Integers, style, units


@dataclass(frozen=True)
class Objective:
    """The objective.

    Attributes:
        label: words, symbol and unit.
        sign: 1 to make it small, -1 to make it large.
        beside: its value in what the best is set against; None if there is nothing.
    """

    label: units.Label
    sign: float
    beside: float | None


def _single(height: float) -> Axes:
    """The axes of a figure that has no others."""
    axis: Axes = style.new_figure(height, 6.0).subplots()
    return axis


def _finished(axis: Axes, x: units.Label, y: units.Label, objective: Objective | None = None) -> Figure:
    """Label both axes, with prefixes of SI units, put the legend above the axes, and return the figure."""
    if objective is not None and objective.beside is not None:
        axis.axhline(objective.beside, color=style.CHAIN_COLOURS[1], linestyle=(0, (4, 1.5)), label="set against")
    for setting, label in ((axis.xaxis, x), (axis.yaxis, y)):
        style.label_axis(setting, label)
    figure = axis.get_figure()
    assert isinstance(figure, Figure)
    figure.legend(loc="outside upper center", ncols=2)
    return figure


@style.styled
def history_figure(objective: Objective, values: Floats) -> Figure:
    """Objective [design] of every design in the order of the search (NaN: outside the limits), and the best so far."""
    axis = _single(3.2)
    number = np.arange(1, len(values) + 1)
    axis.plot(number, values, ".", color="0.7", markersize=3, label="designs")
    best = objective.sign * np.fmin.accumulate(objective.sign * values)
    axis.plot(number, best, color=style.CHAIN_COLOURS[0], drawstyle="steps-post", label="best so far")
    return _finished(axis, units.Label("design"), objective.label, objective)


def front(first: Floats, second: Floats) -> Integers:
    """Places of the pairs [pair] of which no other is smaller in both, in ascending order of the first number."""
    order = np.lexsort((second, first))
    lowest = np.minimum.accumulate(np.concatenate([[np.inf], second[order][:-1]]))
    return np.asarray(order[second[order] < lowest])


@style.styled
def front_figure(objective: Objective, values: Floats, label: units.Label, others: Floats) -> Figure:
    """Objective and a second quantity [design], with the Pareto fronts to small and large values of the second."""
    both_defined = np.isfinite(values) & np.isfinite(others)
    x, y = others[both_defined], values[both_defined]
    axis = _single(3.2)
    axis.plot(x, y, ".", color="0.7", markersize=3, label="designs")
    for sign, colour, side in ((1.0, style.CHAIN_COLOURS[0], "left"), (-1.0, style.CHAIN_COLOURS[2], "right")):
        best = front(objective.sign * y, sign * x)
        order = best[np.argsort(x[best])]
        axis.plot(x[order], y[order], "o-", color=colour, markersize=4, label=f"front to the {side}")
    return _finished(axis, label, objective.label, objective)


@style.styled
def members_figure(objective: Objective, best: float, members: Sequence[float]) -> Figure:
    """Histogram of the objective over designs within manufacturing tolerances."""
    axis = _single(2.6)
    axis.hist(members, bins=max(5, len(members) // 4), color="0.8")
    axis.axvline(best, color=style.CHAIN_COLOURS[0], label="as designed")
    return _finished(axis, objective.label, units.Label("number of members"))


@style.styled
def wall_figure(curves: Sequence[tuple[str, Floats, Floats]], time: units.Label, force: units.Label) -> Figure:
    """Force of all chains together on their far wall over time.

    Args:
        curves: name, times [instant] and forces [instant] of each, in the units of the labels.
        time, force: labels of the axes.
    """
    axis = _single(3.0)
    for place, (name, times, forces) in enumerate(curves):
        axis.plot(times, forces, color=style.CHAIN_COLOURS[place], linestyle=style.CHAIN_DASHES[place], label=name)
    return _finished(axis, time, force)
