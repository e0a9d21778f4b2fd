"""What a search among designs found: its course, the front of two quantities, and what small errors do to the best."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from analysis.figures.style import CHAIN_COLOURS, STYLE, shortened
from analysis.trajectory import Floats, Integers


@dataclass(frozen=True)
class Objective:
    """The objective.

    Attributes:
        label: for an axis.
        sign: 1 to make it small, -1 to make it large.
        beside: its value in what the best is set against; None if there is nothing.
    """

    label: str
    sign: float
    beside: float | None


def _line(axis: Axes, what: Objective) -> None:
    if what.beside is not None:
        axis.axhline(what.beside, color=CHAIN_COLOURS[1], linestyle=(0, (4, 1.5)), label="set against")


def _legend(figure: Figure) -> None:
    """Above the axes, where it hides nothing."""
    figure.legend(loc="outside upper center", ncols=2)


def _name(axis: Axes, x: str, y: str) -> None:
    """Label the axes; SI units have a prefix."""
    for setting, label in ((axis.xaxis, x), (axis.yaxis, y)):
        text, worth = shortened(label, np.asarray(setting.get_data_interval()))
        setting.set_label_text(text)
        if worth != 1.0:
            setting.set_major_formatter(FuncFormatter(lambda value, _, worth=worth: f"{value * worth:.6g}"))


@mpl.rc_context(STYLE)
def history_figure(what: Objective, values: Floats) -> Figure:
    """Every design that keeps the limits (NaN: one that does not), in the order of the search, and the best so far."""
    figure = Figure(figsize=(6.0, 3.2), layout="constrained")
    axis = figure.subplots()
    number = np.arange(1, len(values) + 1)
    axis.plot(number, values, ".", color="0.7", markersize=3, label="designs")
    best = what.sign * np.fmin.accumulate(what.sign * values)
    axis.plot(number, best, color=CHAIN_COLOURS[0], drawstyle="steps-post", label="best so far")
    _line(axis, what)
    _name(axis, "design", what.label)
    _legend(figure)
    return figure


def front(one: Floats, other: Floats) -> Integers:
    """Places of pairs of which none other is smaller in both, by the first."""
    order = np.lexsort((other, one))
    lowest = np.minimum.accumulate(np.concatenate([[np.inf], other[order][:-1]]))
    return np.asarray(order[other[order] < lowest])


@mpl.rc_context(STYLE)
def front_figure(what: Objective, values: Floats, label: str, others: Floats) -> Figure:
    """Two quantities of every design, and those that are best for some value of the second, large or small."""
    known = np.isfinite(values) & np.isfinite(others)
    x, y = others[known], values[known]
    figure = Figure(figsize=(6.0, 3.2), layout="constrained")
    axis = figure.subplots()
    axis.plot(x, y, ".", color="0.7", markersize=3, label="designs")
    for sign, colour, way in ((1.0, CHAIN_COLOURS[0], "left"), (-1.0, CHAIN_COLOURS[2], "right")):
        best = front(what.sign * y, sign * x)
        order = best[np.argsort(x[best])]
        axis.plot(x[order], y[order], "o-", color=colour, markersize=4, label=f"front to the {way}")
    _line(axis, what)
    _name(axis, label, what.label)
    _legend(figure)
    return figure


@mpl.rc_context(STYLE)
def members_figure(what: Objective, best: float, members: Sequence[float]) -> Figure:
    """The objective of designs that are made a little wrong."""
    figure = Figure(figsize=(6.0, 2.6), layout="constrained")
    axis = figure.subplots()
    axis.hist(members, bins=max(5, len(members) // 4), color="0.8")
    axis.axvline(best, color=CHAIN_COLOURS[0], label="as designed")
    _name(axis, what.label, "members")
    _legend(figure)
    return figure


@mpl.rc_context(STYLE)
def wall_figure(curves: Sequence[tuple[str, Floats, Floats]], time_label: str, force_label: str) -> Figure:
    """Force of all chains together on their far wall over time; a name, times and forces for each curve."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axis = figure.subplots()
    for place, (name, time, force) in enumerate(curves):
        axis.plot(time, force, color=CHAIN_COLOURS[place], label=name)
    _name(axis, time_label, force_label)
    _legend(figure)
    return figure
