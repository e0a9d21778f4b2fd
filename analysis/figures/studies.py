"""Figures of many runs: a quantity over one or two swept fields, and its histogram.

Plug-ins take this module to draw what a study has computed: a `StudyAxis` is a column of numbers with its label and
uncertainties, `swept_figure` draws curves and `map_figure` a map; `Sought` marks a value.

Examples:
    >>> coupling = studies.StudyAxis(units.Label("coupling", "k"), studies.floats([0.1, 0.2, 0.4]))
    >>> beads = studies.StudyAxis(units.Label("beads until the pulses agree"), studies.floats([58, 29, None]))
    >>> studies.swept_figure(beads, coupling, title="two chains").savefig(tmp / "study.png", dpi=30)
    >>> beads.values, coupling.logarithmic
    (array([58., 29., nan]), True)
"""

import math
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import LogLocator, MaxNLocator
from numpy.typing import ArrayLike

from analysis.figures.style import (
    CHAIN_COLOURS,
    head,
    label_log_axis,
    legend_below,
    legend_beside,
    new_figure,
    styled,
)
from analysis.statistics import Histogram, Statistics
from analysis.trajectory import Flags, Floats
from lammps_inputs.units import REDUCED, Label

MOST_LINES = 8

_MOST_TICKS = 8

_MARKERS = "osD^v<>p"

_LEVEL = 0.045
"""Height of a row of ticks at the foot, in that of the axes."""

_TITLE = 66
"""Letters that fit above the axes."""

_HEIGHT = 48
"""Letters that fit beside the axes."""

_BLUE = CHAIN_COLOURS[0]

_UNDEFINED: Any = {"facecolor": "white", "edgecolor": "0.6", "hatch": "////", "linewidth": 0.0}
"""Look of a place in a map that has no number."""

_MOST_CONTOURS = 7

_SHADED = "0.9"
"""Colour of ranges in which no small waves pass."""


@dataclass(frozen=True)
class StudyAxis:
    """What an axis shows.

    Attributes:
        label: words, symbol and unit.
        values: one number a case; NaN where there is none.
        error: uncertainty of each; NaN where it is unknown, None where all are.
        unsettled: whether a case had not come to its end state; None where that means nothing.
        error_words: name of the errors in the legend; empty for none.
    """

    label: Label
    values: Floats
    error: Floats | None = None
    unsettled: Flags | None = None
    error_words: str = ""

    @property
    def open(self) -> Flags:
        """Cases, [case], that have a number which may yet change."""
        defined = np.isfinite(self.values)
        return defined & self.unsettled if self.unsettled is not None else np.zeros_like(defined)

    @property
    def logarithmic(self) -> bool:
        """Whether the values are rather spaced by a factor than by a difference."""
        return logarithmic(self.values)

    @property
    def edges(self) -> Floats:
        """Borders [value + 1] of the cells around the distinct values, in their unit, ascending."""
        return edges(np.unique(self.values))

    @property
    def prefixed(self) -> tuple["StudyAxis", float]:
        """Axis with a prefix before its SI unit, such that numbers are short; and the factor."""
        label, worth = self.label.prefixed(largest_of(self.values))
        error = None if self.error is None else self.error * worth
        return replace(self, label=label, values=self.values * worth, error=error), worth


def largest_of(values: Floats) -> float:
    """Size of the largest finite value.

    Args:
        values: [case] in any unit.

    Returns:
        The size, in that unit; 0 where there is no finite value.
    """
    return float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))


def floats(values: Sequence[Any]) -> Floats:
    """Numbers for a figure, [value], in the unit of the values; NaN for None."""
    return np.array([math.nan if value is None else float(value) for value in values], dtype=np.float64)


def logarithmic(values: ArrayLike) -> bool:
    """Whether distinct values are rather spaced by a factor than by a difference."""
    distinct = np.unique(np.asarray(values, dtype=np.float64))
    distinct = distinct[np.isfinite(distinct)]
    if len(distinct) < 3 or distinct[0] <= 0.0 or distinct[-1] / distinct[0] < 3.0:
        return False
    factors, differences = np.diff(np.log(distinct)), np.diff(distinct)
    return bool(factors.max() * differences.min() < differences.max() * factors.min())


@dataclass(frozen=True)
class Sought:
    """A value that a quantity is sought to have, and where it has it.

    Attributes:
        value: of the quantity.
        places: [crossing] of the field.
        errors: [crossing] their uncertainties; NaN where unknown.
    """

    value: float
    places: Floats
    errors: Floats


@styled
def swept_figure(
    quantity: StudyAxis,
    over: StudyAxis,
    beside: StudyAxis | None = None,
    title: str = "",
    passed: Floats | None = None,
    sought: Sought | None = None,
) -> Figure:
    """A quantity over a field, with a line for each value of a second one.

    Bars are uncertainties; cases that are not settled are hollow marks; those without a number are ticks below the axis
    of the quantity.

    Args:
        quantity: the value of each case.
        over: the field along the horizontal axis.
        beside: the second field, of at most `MOST_LINES` values.
        title: for the top.
        passed: ranges [band, 2] in the unit of ``over`` that let small waves pass; all else is shaded.
        sought: a value of the quantity that is marked, and where the quantity has it.
    """
    if sought is not None:
        sought = _prefixed(sought, quantity, over)
    quantity, (over, worth) = quantity.prefixed[0], over.prefixed
    beside, passed = beside and beside.prefixed[0], None if passed is None else passed * worth
    figure = new_figure(3.8, 5.5 if beside is None else 6.5)
    axis = figure.subplots()
    if beside is None:
        holes = int(_line(axis, quantity, over, np.ones(len(over.values), dtype=bool), color=_BLUE, marker="o"))
    else:
        holes = _lines(axis, quantity, over, beside)
    _scale(axis, over, "x")
    if sought is not None:
        _mark(axis, sought, over)
    axis.set_ylabel(wrapped(quantity.label))
    _scale_quantity(axis, quantity, holes)
    if passed is not None:
        _shade_between(axis, passed)
    axis.set_xlabel(over.label.mathtext)
    head(figure, "\n".join(textwrap.wrap(title, _TITLE)))
    handles, labels = axis.get_legend_handles_labels()
    for shown, mark, words in (
        (_has_bars(quantity), _mark_of("_", markersize=9), quantity.error_words),
        (bool(np.any(quantity.open)), _mark_of("o"), "not settled"),
        (holes > 0, _mark_of("|", markersize=7), "no number"),
        (passed is not None, Patch(color=_SHADED), "no small waves pass"),
    ):
        handles, labels = ([*handles, mark], [*labels, words]) if shown else (handles, labels)
    (legend_below if beside is None else legend_beside)(figure, handles, labels)
    return figure


def _has_bars(quantity: StudyAxis) -> bool:
    """Whether any case that has a number has an uncertainty of it, which is drawn as a bar and named in the legend."""
    if quantity.error is None or not quantity.error_words:
        return False
    return bool(np.any(np.isfinite(quantity.error) & np.isfinite(quantity.values)))


def _mark_of(marker: str, **look: Any) -> Line2D:
    """Black mark, white inside, of an entry in a legend."""
    return Line2D([], [], linestyle="none", color="black", marker=marker, markerfacecolor="white", **look)


@styled
def map_figure(quantity: StudyAxis, over: StudyAxis, beside: StudyAxis, title: str = "") -> Figure:
    """Map with contours of a quantity over two fields, whose axes are logarithmic where the values are spaced so.

    Places without a number are blank and hatched; cases that are not settled are crosses.

    Args:
        quantity: the value of each case.
        over: the field along the horizontal axis.
        beside: the field along the vertical axis.
        title: for the top.
    """
    quantity, over, beside = (shown.prefixed[0] for shown in (quantity, over, beside))
    figure = new_figure(3.8, 5.5)
    axis = figure.subplots()
    columns, rows = np.unique(over.values), np.unique(beside.values)
    grid = np.full((len(rows), len(columns)), np.nan)
    grid[np.searchsorted(rows, beside.values), np.searchsorted(columns, over.values)] = quantity.values
    axis.patch.set(**_UNDEFINED)
    log = over_decades(grid)
    mesh = axis.pcolormesh(
        edges(columns), edges(rows), grid, cmap="viridis", norm="log" if log else None, rasterized=True
    )
    for shown, name in ((over, "x"), (beside, "y")):
        _scale(axis, shown, name)
    _contours(axis, columns, rows, grid, log=log)
    for colour, size in (("white", 5.0), ("black", 3.5)):
        axis.plot(over.values[quantity.open], beside.values[quantity.open], "x", color=colour, markersize=size)
    axis.set_xlabel(over.label.mathtext)
    axis.set_ylabel(wrapped(beside.label))
    figure.colorbar(mesh, ax=axis, label=wrapped(quantity.label))
    head(figure, "\n".join(textwrap.wrap(title, _TITLE)))
    marks: list[tuple[bool, Any, str]] = [
        (bool(np.any(quantity.open)), _mark_of("x"), "not settled"),
        (bool(np.isnan(grid).any()), Patch(**_UNDEFINED), "no number"),
    ]
    shown_marks = [(mark, words) for is_shown, mark, words in marks if is_shown]
    legend_below(figure, [mark for mark, _ in shown_marks], [words for _, words in shown_marks])
    return figure


def _contours(axis: Axes, columns: Floats, rows: Floats, grid: Floats, *, log: bool) -> None:
    """Draw labelled contours of a map [row, column] through the centres of its cells, where there are any."""
    finite = grid[np.isfinite(grid)]
    if min(grid.shape) < 2 or len(finite) == 0:
        return
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if log else MaxNLocator(_MOST_CONTOURS, steps=[1, 2, 5, 10])
    levels = np.asarray(locator.tick_values(float(finite.min()), float(finite.max())))
    levels = levels[(levels > finite.min()) & (levels < finite.max())]
    if len(levels) == 0:
        return
    contours = axis.contour(columns, rows, np.ma.masked_invalid(grid), levels, colors="white", linewidths=0.9)
    outline: list[AbstractPathEffect] = [withStroke(linewidth=2.0, foreground="0.15")]
    contours.set_path_effects(outline)
    for text in axis.clabel(contours, fontsize=7, fmt=lambda level: f"{level:g}"):
        text.set_path_effects(outline)


@styled
def histogram_figure(label: Label, bins: Histogram, statistics: Statistics, title: str = "") -> Figure:
    """Histogram of a quantity, with its mean, the standard error of that, and the median.

    Args:
        label: of the quantity.
        bins: number of values in each bin.
        statistics: mean, standard error and quantiles of the values.
        title: for the top.
    """
    label, worth = label.prefixed(largest_of(np.array([bins.low[0], bins.high[-1]])))
    figure = new_figure(3.2, 5.5)
    axis = figure.subplots()
    ends = np.append(bins.low, bins.high[-1]) * worth
    if len(bins.low) == 1:  # all values are equal
        ends = edges(ends[:1])
    axis.stairs(bins.count, ends, fill=True, color="0.8")
    axis.axvline(statistics.mean * worth, color=_BLUE, label="mean")
    if math.isfinite(statistics.standard_error):
        low, high = ((statistics.mean + sign * statistics.standard_error) * worth for sign in (-1.0, 1.0))
        axis.axvspan(low, high, color=_BLUE, alpha=0.25, linewidth=0.0, label="standard error of the mean")
    axis.axvline(statistics.q50 * worth, color=CHAIN_COLOURS[1], linestyle=(0, (4, 1.5)), label="median")
    axis.set_xlabel(label.mathtext)
    axis.set_ylabel("number of cases")
    axis.yaxis.set_major_locator(MaxNLocator(integer=True))
    head(figure, "\n".join(textwrap.wrap(title, _TITLE)))
    legend_below(figure, *axis.get_legend_handles_labels())
    return figure


def wrapped(label: Label) -> str:
    """Text of a vertical axis, in lines that fit its height; none ends within mathematics."""
    unbroken = re.sub(r"\$[^$]*\$", lambda mathematics: mathematics[0].replace(" ", _NO_BREAK), label.mathtext)
    return "\n".join(textwrap.wrap(unbroken, _HEIGHT)).replace(_NO_BREAK, " ")


_NO_BREAK = "\u00a0"


def _prefixed(sought: Sought, quantity: StudyAxis, over: StudyAxis) -> Sought:
    along = over.prefixed[1]
    return Sought(sought.value * quantity.prefixed[1], sought.places * along, sought.errors * along)


def _mark(axis: Axes, sought: Sought, over: StudyAxis) -> None:
    """Draw the value that is sought as a line, and the places where the quantity has it with their uncertainties."""
    axis.axhline(
        sought.value, color="0.4", linewidth=1.0, linestyle=(0, (4, 2)), label=f"value sought: {sought.value:g}"
    )
    for number, (place, error) in enumerate(zip(sought.places.tolist(), sought.errors.tolist(), strict=True)):
        certain = math.isfinite(error) and error > 0.0
        digits = max(0, 1 - math.floor(math.log10(error))) if certain else 4
        written = f"{place:.{digits}f} \u00b1 {error:.{digits}f}" if certain else f"{place:.4g}"
        label = f"crossing: {over.label.symbol and f'${over.label.symbol}$ = '}{written}"
        bar = error if certain else None
        look: dict[str, Any] = {"color": CHAIN_COLOURS[1 + number % 3], "markersize": 8, "capsize": 3.0, "zorder": 4}
        axis.errorbar([place], [sought.value], xerr=bar, fmt="x", label=label, **look)


def _scale_quantity(axis: Axes, quantity: StudyAxis, holes: int) -> None:
    """Scale the axis of a quantity, not below 0 for a margin alone; below it cases without a number have room."""
    finite = quantity.values[np.isfinite(quantity.values)]
    if over_decades(finite):
        axis.set_yscale("log")
        label_log_axis(axis.yaxis)
    else:
        axis.ticklabel_format(axis="y", scilimits=(-3, 6), useMathText=True)
        _whole(axis.yaxis, finite)
        if len(finite) and finite.min() >= 0.0 and axis.get_ylim()[0] < 0.0:
            axis.set_ylim(bottom=0.0)
    if holes:
        _leave_room(axis, holes * _LEVEL)


def over_decades(values: Floats) -> bool:
    """Whether values [case] are positive, but for those that are NaN, and differ by a factor of more than 30."""
    finite = values[np.isfinite(values)]
    return len(finite) > 0 and bool(finite.min() > 0.0 and finite.max() / finite.min() > 30.0)


def _line(axis: Axes, quantity: StudyAxis, over: StudyAxis, cases: Flags, level: int = 0, **look: Any) -> bool:
    """Draw some cases; those without a number as ticks below, on a level for each line. Whether there are any."""
    chosen = np.flatnonzero(cases)[np.argsort(over.values[cases], kind="stable")]
    x, y = over.values[chosen], quantity.values[chosen]
    axis.plot(x, y, markersize=5, **look)
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
        certain = np.isfinite(quantity.error[chosen])
        bars = quantity.error[chosen][certain]
        axis.errorbar(x[certain], y[certain], bars, fmt="none", ecolor=look["color"], elinewidth=0.9, capsize=2.5)
    return len(missing) > 0


def _lines(axis: Axes, quantity: StudyAxis, over: StudyAxis, beside: StudyAxis) -> int:
    """Draw a line for each value of the second field; how many of them lack numbers."""
    holes = 0
    numbers = np.unique(beside.values)
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(numbers)))
    label = beside.label
    name = f"${label.symbol}$" if label.symbol else label.words
    unit = f" {label.unit}" if label.unit not in ("", REDUCED) else ""
    for k, number in enumerate(numbers):
        look = {"color": colours[k], "marker": _MARKERS[k], "label": f"{name} = {number:.6g}{unit}"}
        holes += _line(axis, quantity, over, beside.values == number, holes, **look)
    return holes


def _leave_room(axis: Axes, share: float) -> None:
    """Let a share of the height at the foot be free; the axis of the quantity ends above it."""
    scale = axis.yaxis.get_transform()
    bottom, top = axis.get_ylim()
    ticks = [(minor, axis.get_yticks(minor=minor)) for minor in (False, True)]
    low, high = scale.transform(np.array([bottom, top]))
    axis.set_ylim(bottom=float(scale.inverted().transform(np.array([low - share / (1.0 - share) * (high - low)]))[0]))
    for minor, places in ticks:
        axis.set_yticks(places[(places >= bottom) & (places <= top)], minor=minor)
    axis.spines["left"].set_bounds(bottom, top)


def _shade_between(axis: Axes, passed: Floats) -> None:
    """Shade what lies outside all bands, and draw their edges."""
    first, last = axis.get_xlim()
    reached = first
    for low, high in [*sorted(passed.tolist()), [last, last]]:
        if min(low, last) > reached:
            axis.axvspan(reached, min(low, last), color=_SHADED, zorder=0)
        reached = max(reached, high)
    for edge in passed[(passed > first) & (passed < last)]:
        axis.axvline(edge, color="0.5", linewidth=0.8, linestyle=":")
    axis.set_xlim(first, last)


def edges(centres: Floats) -> Floats:
    """Borders [value + 1] of the cells around values [value], half-way between them, also by factors."""
    if len(centres) == 1:
        half = 0.5 * abs(centres[0]) or 0.5
        return np.array([centres[0] - half, centres[0] + half])
    log = logarithmic(centres)
    places = np.log(centres) if log else centres
    between = 0.5 * (places[1:] + places[:-1])
    edges = np.concatenate([[2.0 * places[0] - between[0]], between, [2.0 * places[-1] - between[-1]]])
    return np.exp(edges) if log else edges


def _scale(axis: Axes, shown: StudyAxis, name: str) -> None:
    """Logarithmic where the values are spaced so; few values are the ticks themselves."""
    values = np.unique(shown.values)
    setting = axis.xaxis if name == "x" else axis.yaxis
    log = logarithmic(values)
    if log:
        (axis.set_xscale if name == "x" else axis.set_yscale)("log")
    if len(values) <= _MOST_TICKS and (log or _even(values)):
        _ticks_at(setting, values)
    elif log:
        label_log_axis(setting)
    else:
        _whole(setting, values)


def _ticks_at(setting: XAxis | YAxis, values: Floats) -> None:
    setting.set_ticks(values.tolist(), labels=[f"{value:.3g}" for value in values])
    setting.set_ticks([], minor=True)


def _whole(setting: XAxis | YAxis, values: Floats) -> None:
    """Ticks of whole numbers, such as beads, are whole."""
    if len(values) and np.all(values == np.round(values)) and np.ptp(values) >= 1.0:
        setting.set_major_locator(MaxNLocator(integer=True))


def _even(values: Sequence[float] | Floats) -> bool:
    """Whether no two values are so close that their labels would run into each other."""
    gaps = np.diff(np.asarray(values))
    return len(gaps) == 0 or bool(gaps.min() > 0.5 * gaps.max())
