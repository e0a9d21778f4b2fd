"""Rigid and elastic beads: impulses along the chains, velocities of a few rows, and how equally two gapped chains share
a pulse, over the gap (rigid beads) and along the chain (both).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granchain.parts import Floats, Integers, Problem, panels, style

ENGINE_LOOKS: tuple[dict[str, Any], ...] = (
    {"linestyle": "-", "linewidth": 3.5, "alpha": 0.35},
    {"linestyle": "-", "linewidth": 1.2},
)
"""Wide and pale, and thin: each is seen where both lie on one another."""

CHAIN_MARKERS = "o^sDv<>P"


@dataclass(frozen=True)
class EngineCurve:
    """One engine's results, dimensionless.

    Attributes:
        engine: its name.
        time, velocity: of the shown rows, [frame] and [frame, chain, shown row].
        bead, first: numbers of the receiving beads, and impulse of their first contact, [row] and [chain, row].
    """

    engine: str
    time: Floats
    velocity: Floats
    bead: Integers
    first: Floats


@style.styled
def engines_figure(problem: Problem, rows: Sequence[int], curves: Sequence[EngineCurve]) -> Figure:
    """First impulses of all rows above, one panel an engine; below the velocities of a few rows.

    A colour and, above, a marker is a chain; below, a line style is an engine.
    """
    chains = panels.shown_chains(problem)
    spans = [_window(curves, position) for position in range(len(rows))]
    time = panels.axis_unit(problem, "time", max(high for _, high in spans))
    velocity = panels.axis_unit(
        problem, "velocity", max(float(np.abs(curve.velocity).max(initial=0.0)) for curve in curves)
    )
    figure = style.new_figure(3.0 + 1.8 * len(rows), 7.5)
    grid = figure.add_gridspec(1 + len(rows), len(curves), height_ratios=[1.3] + [1.0] * len(rows))
    first = None
    for column, curve in enumerate(curves):
        first = figure.add_subplot(grid[0, column], sharey=first)
        for place, chain in enumerate(chains):
            kicked = np.where(curve.first[chain] > 0.0, curve.first[chain], np.nan)
            first.plot(curve.bead, kicked, **_chain_marks(place))
        first.set_title(curve.engine, loc="left")
        first.set_xlabel("bead")
        if column == 0:
            first.set_ylabel("first impulse $I / (m V)$")
        first.set_xlim(0, problem.beads + 1)
    for position, (row, span) in enumerate(zip(rows, spans, strict=True)):
        axis = figure.add_subplot(grid[1 + position, :])
        for number, curve in enumerate(curves):
            for place, chain in enumerate(chains):
                values = curve.velocity[:, chain, position] * velocity.worth
                axis.plot(curve.time * time.worth, values, color=_colour(place), label=curve.engine, **_look(number))
        axis.set_xlim(span[0] * time.worth, span[1] * time.worth)
        axis.set_title(f"bead {row}", loc="left")
        axis.set_ylabel(velocity.axis(panels.FrameContent, "velocity").label.mathtext)
    style.letter(figure.axes)
    axis.set_xlabel(time.axis(panels.FrameContent, "time").label.mathtext)
    handles = [Line2D([], [], color="black", label=curve.engine, **_look(k)) for k, curve in enumerate(curves)]
    if len(chains) > 1:
        handles += [Line2D([], [], label=f"chain {chain + 1}", **_chain_marks(k)) for k, chain in enumerate(chains)]
    style.legend_below(figure, handles, [str(handle.get_label()) for handle in handles])
    style.head(figure, panels.title(problem, each_chain=True))
    return figure


def _colour(place: int) -> str:
    return style.CHAIN_COLOURS[place % len(style.CHAIN_COLOURS)]


def _look(engine: int) -> dict[str, Any]:
    return ENGINE_LOOKS[engine % len(ENGINE_LOOKS)]


def _chain_marks(place: int) -> dict[str, Any]:
    """The second chain is hollow, so that a first one under it is seen."""
    return {
        "color": _colour(place),
        "marker": CHAIN_MARKERS[place % len(CHAIN_MARKERS)],
        "markerfacecolor": "none" if place % 2 else None,
        "markersize": 3.5 if place % 2 else 2.5,
        "markeredgewidth": 0.6,
        "linestyle": "none",
    }


def _window(curves: Sequence[EngineCurve], position: int) -> tuple[float, float]:
    """The time in which the pulse passes a row in any engine: from the first motion to the last of half the largest.

    In units of T.
    """
    moving = []
    for curve in curves:
        size = np.abs(curve.velocity[:, :, position]).max(axis=1)
        if size.max() > 1e-2:
            moving += [curve.time[np.argmax(size > 1e-2)], curve.time[np.flatnonzero(size > 0.5 * size.max())[-1]]]
    low, high = (min(moving), max(moving)) if moving else (0.0, float(curves[0].time[-1]))
    margin = 0.15 * (high - low) + 0.5
    return max(0.0, low - margin), min(high + margin, float(curves[0].time[-1]))


@dataclass(frozen=True)
class PublishedPoint:
    """A gap that a publication chose, and the difference of the chains' first impulses there.

    Attributes:
        label: for the legend.
        theta: omega D / V.
        difference: [row].
    """

    label: str
    theta: float
    difference: Floats


@style.styled
def scan_figure(
    theta: Floats, differences: Floats, rows: Sequence[int], agree: float, published: PublishedPoint
) -> Figure:
    """Difference of the chains' first impulses over theta, a panel for each row; a difference of 0 is not drawn.

    Args:
        theta: omega D / V, [theta].
        differences: (largest - smallest) / mean, [theta, row].
        rows: numbers of the rows.
        agree: below which chains count as equal; drawn as a line.
        published: a point that is marked.
    """
    figure = style.new_figure(1.0 + 1.7 * len(rows), 8.0)
    axes = figure.subplots(len(rows), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for place, (axis, row, difference) in enumerate(zip(axes, rows, differences.T, strict=True)):
        positive = np.where(difference > 0.0, difference, np.nan)
        axis.plot(theta, positive, ".", markersize=2, color=style.CHAIN_COLOURS[0], label="rigid beads")
        axis.axhline(agree, color="black", linewidth=0.8, label=f"{100.0 * agree:g} %")
        at = [published.theta], [published.difference[place] or np.nan]
        axis.plot(*at, "D", color=style.CHAIN_COLOURS[1], markersize=6, markeredgecolor="black", label=published.label)
        axis.axvline(published.theta, color=style.CHAIN_COLOURS[1], linewidth=0.8, zorder=0)
        axis.set_yscale("log")
        axis.set_title(f"row {row}", loc="left")
    style.label_log_axis(axes[0].yaxis)
    style.letter(axes)
    figure.supylabel("difference of the chains' first impulses / mean", fontsize="medium")
    axes[-1].set_xlabel(r"$\theta = \omega D / V$")
    style.legend_below(figure, *axes[0].get_legend_handles_labels())
    return figure


SMALLEST = 1e-5
"""Least relative difference that is drawn: below it the uncertainty of the runs decides."""


@style.styled
def relative_mode_figure(curves: Sequence[tuple[str, Integers, Floats]]) -> Figure:
    """|I1 - I2| / (I1 + I2) of first impulses along the chains; curves are interrupted where it is below `SMALLEST`.

    Args:
        curves: label, row numbers [row] and values [row] of each model; dimensionless.
    """
    figure = style.new_figure(3.6)
    axis = figure.subplots()
    for k, (label, bead, difference) in enumerate(curves):
        size = np.abs(difference)
        axis.plot(
            bead,
            np.where(size >= SMALLEST, size, np.nan),
            color=style.CHAIN_COLOURS[k % len(style.CHAIN_COLOURS)],
            linestyle=style.CHAIN_DASHES[k % len(style.CHAIN_DASHES)],
            label=label,
        )
    axis.set_yscale("log")
    axis.set_ylim(SMALLEST, 1.5)
    axis.set_xlabel("row")
    axis.set_ylabel("$|I_1 - I_2| / (I_1 + I_2)$")
    style.legend_below(figure, *axis.get_legend_handles_labels())  # the curves fill the axes
    return figure
