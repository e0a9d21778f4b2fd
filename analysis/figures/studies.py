"""Figures of many runs: one quantity over one swept field or over two, and what a search among designs found."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import ArrayLike

from analysis.figures.style import CHAIN_COLOURS, STYLE, shortened
from analysis.trajectory import Flags, Floats, Integers

MOST_LINES = 8

_MOST_TICKS = 8

_DIGITS = {10.0: (1.0, 2.0, 3.0, 4.0, 5.0, 7.0), 300.0: (1.0, 2.0, 5.0)}
"""First digits that are labelled on a logarithmic axis, up to a ratio of its values; beyond these powers of ten."""

_MARKERS = "osD^v<>p"

_LEVEL = 0.045
"""Height of a row of ticks at the foot, in that of the axes."""

_TITLE = 66
"""Letters that fit above the axes."""


@dataclass(frozen=True)
class Axis:
    """What an axis shows.

    Attributes:
        label: with its unit.
        values: one number a case; NaN where there is none.
        error: uncertainty of each; NaN where it is unknown, None where all are.
        unsettled: whether a case had not come to its end state; None where that means nothing.
        bands: ranges around the values, the widest first, each [low or high, case]; NaN where undefined.
    """

    label: str
    values: Floats
    error: Floats | None = None
    unsettled: Flags | None = None
    bands: tuple[Floats, ...] = ()

    @property
    def open(self) -> Flags:
        """Cases that have a number which may yet change."""
        found = np.isfinite(self.values)
        return found & self.unsettled if self.unsettled is not None else np.zeros_like(found)

    @property
    def prefixed(self) -> tuple["Axis", float]:
        """The same with a prefix before an SI unit, such that numbers are short; and the factor."""
        label, worth = shortened(self.label, self.values)
        error = None if self.error is None else self.error * worth
        bands = tuple(band * worth for band in self.bands)
        return replace(self, label=label, values=self.values * worth, error=error, bands=bands), worth


def logarithmic(values: ArrayLike) -> bool:
    """Whether distinct values are rather spaced by a factor than by a difference."""
    found = np.unique(np.asarray(values, dtype=np.float64))
    found = found[np.isfinite(found)]
    if len(found) < 3 or found[0] <= 0.0 or found[-1] / found[0] < 3.0:
        return False
    factors, differences = np.diff(np.log(found)), np.diff(found)
    return bool(factors.max() * differences.min() < differences.max() * factors.min())


@mpl.rc_context(STYLE)
def swept_figure(
    quantity: Axis, over: Axis, beside: Axis | None = None, title: str = "", passed: Floats | None = None
) -> Figure:
    """A quantity over a field, and over a second one as lines or, from nine values on, as the rows of a map.

    Bars are uncertainties (lines only); cases that are not settled are hollow marks, in a map crosses; those without a
    number are ticks at the foot, in a map grey.

    Args:
        quantity: the value of each case.
        over: the field along the horizontal axis.
        beside: the second field.
        title: for the top.
        passed: ranges of the horizontal axis, [band, 2], that let small waves pass; all else is shaded.
    """
    quantity, (over, worth) = quantity.prefixed[0], over.prefixed
    beside, passed = beside and beside.prefixed[0], None if passed is None else passed * worth
    figure = Figure(figsize=(5.5 if beside is None else 6.5, 3.8), layout="constrained")
    axis = figure.subplots()
    notes = [title] if title else []
    is_map = beside is not None and len(np.unique(beside.values)) > MOST_LINES
    if np.any(quantity.open):
        notes.append(f"{'crossed' if is_map else 'hollow'}: not settled")
    holes: int  # lines that lack numbers
    if beside is None:
        holes = _line(axis, quantity, over, np.ones(len(over.values), dtype=bool), color="#0072B2", marker="o")
    elif is_map:
        holes = _map(figure, axis, quantity, over, beside)
    else:
        holes = _lines(axis, quantity, over, beside)
    if holes:
        notes.append(f"{'grey' if is_map else 'ticks at the foot'}: no number")
    if not is_map:
        axis.set_ylabel(quantity.label)
        finite = quantity.values[np.isfinite(quantity.values)]
        if len(finite) and finite.min() > 0.0 and finite.max() / finite.min() > 30.0:
            axis.set_yscale("log")
        else:
            axis.ticklabel_format(axis="y", scilimits=(-3, 6), useMathText=True)
            _whole(axis.yaxis, finite)
        if holes:
            _leave_room(axis, holes * _LEVEL)
    _scale(axis, over, "x")
    if passed is not None:
        _shade_between(axis, passed)
        notes.append("shaded: no small waves pass")
    axis.set_xlabel(over.label)
    axis.set_title("\n".join(textwrap.wrap("; ".join(notes), _TITLE)))
    return figure


def _line(axis: Axes, quantity: Axis, over: Axis, here: Flags, level: int = 0, **look: Any) -> bool:
    """The cases here; where they have no number, ticks at the foot, on a level for each line. Whether there are any."""
    chosen = np.flatnonzero(here)[np.argsort(over.values[here], kind="stable")]
    x, y = over.values[chosen], quantity.values[chosen]
    axis.plot(x, y, markersize=5, **look)
    for low, high in quantity.bands:
        axis.fill_between(x, low[chosen], high[chosen], color=look["color"], alpha=0.2, linewidth=0.0)
    missing = x[~np.isfinite(y)]
    if len(missing):
        axis.plot(
            missing,
            np.full(len(missing), _LEVEL * (level + 0.6)),
            color=look["color"],
            marker="|",
            markersize=7,
            linestyle="none",
            transform=axis.get_xaxis_transform(),
        )
    hollow = quantity.open[chosen]
    if hollow.any():
        marks = {"color": look["color"], "marker": look["marker"], "markerfacecolor": "white", "linestyle": "none"}
        axis.plot(x[hollow], y[hollow], markersize=5, zorder=3, **marks)
    if quantity.error is not None:
        known = np.isfinite(quantity.error[chosen])
        bars = quantity.error[chosen][known]
        axis.errorbar(x[known], y[known], bars, fmt="none", ecolor=look["color"], elinewidth=0.9, capsize=2.5)
    return len(missing) > 0


def _lines(axis: Axes, quantity: Axis, over: Axis, beside: Axis) -> int:
    """A line for each value of the second field; how many of them lack numbers."""
    holes = 0
    numbers = np.unique(beside.values)
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(numbers)))
    for k, number in enumerate(numbers):
        here = beside.values == number
        holes += _line(axis, quantity, over, here, holes, color=colours[k], marker=_MARKERS[k], label=f"{number:.6g}")
    # beside the axes, where no line can run through it
    axis.legend(title=beside.label, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return holes


def _leave_room(axis: Axes, share: float) -> None:
    """Let a share of the height at the foot be free."""
    scale = axis.yaxis.get_transform()
    low, high = scale.transform(np.array(axis.get_ylim()))
    axis.set_ylim(bottom=float(scale.inverted().transform(np.array([low - share / (1.0 - share) * (high - low)]))[0]))


def _map(figure: Figure, axis: Axes, quantity: Axis, over: Axis, beside: Axis) -> bool:
    """Draw a map; whether it has holes."""
    columns, rows = np.unique(over.values), np.unique(beside.values)
    grid = np.full((len(rows), len(columns)), np.nan)
    grid[np.searchsorted(rows, beside.values), np.searchsorted(columns, over.values)] = quantity.values
    axis.plot(over.values[quantity.open], beside.values[quantity.open], "x", color="white", markersize=5)
    axis.plot(over.values[quantity.open], beside.values[quantity.open], "x", color="black", markersize=3.5)
    axis.set_facecolor("0.85")
    mesh = axis.pcolormesh(_edges(columns), _edges(rows), grid, cmap="viridis", rasterized=True)
    _scale(axis, beside, "y")
    axis.set_ylabel(beside.label)
    figure.colorbar(mesh, ax=axis, label=quantity.label)
    return bool(np.isnan(grid).any())


def _shade_between(axis: Axes, passed: Floats) -> None:
    """Shade what lies outside all bands, and draw their edges."""
    first, last = axis.get_xlim()
    reached = first
    for low, high in [*sorted(passed.tolist()), [last, last]]:
        if min(low, last) > reached:
            axis.axvspan(reached, min(low, last), color="0.9", zorder=0)
        reached = max(reached, high)
    for edge in passed[(passed > first) & (passed < last)]:
        axis.axvline(edge, color="0.5", linewidth=0.8, linestyle=":")
    axis.set_xlim(first, last)


def _edges(centres: Floats) -> Floats:
    """Borders of the cells around values: half-way between them, by factors where they are spaced so."""
    if len(centres) == 1:
        half = 0.5 * abs(centres[0]) or 0.5
        return np.array([centres[0] - half, centres[0] + half])
    log = logarithmic(centres)
    places = np.log(centres) if log else centres
    between = 0.5 * (places[1:] + places[:-1])
    edges = np.concatenate([[2.0 * places[0] - between[0]], between, [2.0 * places[-1] - between[-1]]])
    return np.exp(edges) if log else edges


def _scale(axis: Axes, shown: Axis, name: str) -> None:
    """Logarithmic where the values are spaced so; few values are the ticks themselves."""
    values = np.unique(shown.values)
    setting = axis.xaxis if name == "x" else axis.yaxis
    log = logarithmic(values)
    if log:
        (axis.set_xscale if name == "x" else axis.set_yscale)("log")
    if len(values) <= _MOST_TICKS and (log or _even(values)):
        _ticks_at(setting, values)
    elif log:
        setting.set_minor_formatter(NullFormatter())  # its labels of single digits run into each other
        digits = next((digits for ratio, digits in _DIGITS.items() if values[-1] / values[0] < ratio), None)
        if digits is not None:
            setting.set_major_locator(LogLocator(subs=digits))
            setting.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    else:
        _whole(setting, values)


def _ticks_at(setting: XAxis | YAxis, values: Floats) -> None:
    setting.set_ticks(values.tolist(), labels=[f"{value:.4g}" for value in values])
    setting.set_ticks([], minor=True)


def _whole(setting: XAxis | YAxis, values: Floats) -> None:
    """Ticks of whole numbers, such as beads, are whole."""
    if len(values) and np.all(values == np.round(values)) and np.ptp(values) >= 1.0:
        setting.set_major_locator(MaxNLocator(integer=True))


def _even(values: Sequence[float] | Floats) -> bool:
    """Whether no two values are so close that their labels would run into each other."""
    gaps = np.diff(np.asarray(values))
    return len(gaps) == 0 or bool(gaps.min() > 0.5 * gaps.max())


# --- a search among designs -------------------------------------------------------------------------------------------


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


def _single(height: float) -> Axes:
    """The axes of a figure that has no others."""
    return Figure(figsize=(6.0, height), layout="constrained").subplots()


def _finished(axis: Axes, x: str, y: str, what: Objective | None = None) -> Figure:
    """The figure, with its labels, SI units with a prefix, and a legend above the axes, where it hides nothing."""
    if what is not None and what.beside is not None:
        axis.axhline(what.beside, color=CHAIN_COLOURS[1], linestyle=(0, (4, 1.5)), label="set against")
    for setting, label in ((axis.xaxis, x), (axis.yaxis, y)):
        text, worth = shortened(label, np.asarray(setting.get_data_interval()))
        setting.set_label_text(text)
        if worth != 1.0:
            setting.set_major_formatter(FuncFormatter(lambda value, _, worth=worth: f"{value * worth:.6g}"))
    figure = axis.get_figure()
    assert isinstance(figure, Figure)
    figure.legend(loc="outside upper center", ncols=2)
    return figure


@mpl.rc_context(STYLE)
def history_figure(what: Objective, values: Floats) -> Figure:
    """Every design that keeps the limits (NaN: one that does not), in the order of the search, and the best so far."""
    axis = _single(3.2)
    number = np.arange(1, len(values) + 1)
    axis.plot(number, values, ".", color="0.7", markersize=3, label="designs")
    best = what.sign * np.fmin.accumulate(what.sign * values)
    axis.plot(number, best, color=CHAIN_COLOURS[0], drawstyle="steps-post", label="best so far")
    return _finished(axis, "design", what.label, what)


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
    axis = _single(3.2)
    axis.plot(x, y, ".", color="0.7", markersize=3, label="designs")
    for sign, colour, way in ((1.0, CHAIN_COLOURS[0], "left"), (-1.0, CHAIN_COLOURS[2], "right")):
        best = front(what.sign * y, sign * x)
        order = best[np.argsort(x[best])]
        axis.plot(x[order], y[order], "o-", color=colour, markersize=4, label=f"front to the {way}")
    return _finished(axis, label, what.label, what)


@mpl.rc_context(STYLE)
def members_figure(what: Objective, best: float, members: Sequence[float]) -> Figure:
    """The objective of designs that are made a little wrong."""
    axis = _single(2.6)
    axis.hist(members, bins=max(5, len(members) // 4), color="0.8")
    axis.axvline(best, color=CHAIN_COLOURS[0], label="as designed")
    return _finished(axis, what.label, "members")


@mpl.rc_context(STYLE)
def wall_figure(curves: Sequence[tuple[str, Floats, Floats]], time_label: str, force_label: str) -> Figure:
    """Force of all chains together on their far wall over time; a name, times and forces for each curve."""
    axis = _single(3.0)
    for place, (name, time, force) in enumerate(curves):
        axis.plot(time, force, color=CHAIN_COLOURS[place], label=name)
    return _finished(axis, time_label, force_label)
