"""Rigid and elastic beads: impulses along the chains, velocities of a few rows, and how equally two gapped chains share
a pulse, over the gap (rigid beads) and along the chain (both).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.figures.style import CHAIN_COLOURS, CHAIN_DASHES, STYLE, Frames, axis_unit, letter, shown_chains, title
from analysis.trajectory import Floats, Integers
from lammps_inputs import Problem

ENGINE_LOOKS: tuple[dict[str, Any], ...] = (
    {"linestyle": "-", "linewidth": 3.5, "alpha": 0.35},
    {"linestyle": "-", "linewidth": 1.2},
)
"""Wide and pale, and thin: each is seen where both lie on one another."""

CHAIN_MARKERS = "o^sDv<>P"


@dataclass(frozen=True)
class Curve:
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


@mpl.rc_context(STYLE)
def engines_figure(problem: Problem, rows: Sequence[int], curves: Sequence[Curve]) -> Figure:
    """First impulses of all rows above, one panel an engine; below the velocities of a few rows.

    A colour and, above, a marker is a chain; below, a line style is an engine.
    """
    chains = shown_chains(problem)
    spans = [_window(curves, position) for position in range(len(rows))]
    time = axis_unit(problem, "time", max(high for _, high in spans))
    velocity = axis_unit(problem, "velocity", max(float(np.abs(curve.velocity).max(initial=0.0)) for curve in curves))
    figure = Figure(figsize=(7.5, 3.0 + 1.8 * len(rows)), layout="constrained")
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
        axis.set_ylabel(velocity.label(Frames, "velocity"))
    letter(figure.axes)
    axis.set_xlabel(time.label(Frames, "time"))
    handles = [Line2D([], [], color="black", label=curve.engine, **_look(k)) for k, curve in enumerate(curves)]
    if len(chains) > 1:
        handles += [Line2D([], [], label=f"chain {chain + 1}", **_chain_marks(k)) for k, chain in enumerate(chains)]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 6))
    figure.suptitle(title(problem, each_chain=True))
    return figure


def _colour(place: int) -> str:
    return CHAIN_COLOURS[place % len(CHAIN_COLOURS)]


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


def _window(curves: Sequence[Curve], position: int) -> tuple[float, float]:
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


@mpl.rc_context(STYLE)
def scan_figure(theta: Floats, differences: Floats, rows: Sequence[int], agree: float) -> Figure:
    """Difference of the chains' first impulses over theta, a panel for each row.

    Args:
        theta: omega D / V, [theta].
        differences: (largest - smallest) / mean, [theta, row].
        rows: numbers of the rows.
        agree: below which chains count as equal; drawn as a line.
    """
    figure = Figure(figsize=(8.0, 1.0 + 1.7 * len(rows)), layout="constrained")
    axes = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
    for axis, row, difference in zip(axes, rows, differences.T, strict=True):
        axis.plot(theta, np.maximum(difference, 1e-4), ".", markersize=2, color=CHAIN_COLOURS[0])
        axis.axhline(agree, color="black", linewidth=0.8)
        axis.set_yscale("log")
        axis.set_ylim(8e-5, 3.0)
        axis.set_title(f"row {row}", loc="left")
    letter(axes)
    figure.supylabel("difference of the chains' first impulses / mean")
    axes[-1].set_xlabel(r"$\theta = \omega D / V$")
    return figure


@mpl.rc_context(STYLE)
def relative_mode_figure(curves: Sequence[tuple[str, Integers, Floats]]) -> Figure:
    """|I1 - I2| / (I1 + I2) of first impulses along the chains.

    Args:
        curves: label, row numbers and values of each model.
    """
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    axis = figure.subplots()
    for k, (label, bead, difference) in enumerate(curves):
        axis.plot(
            bead,
            np.abs(difference),
            color=CHAIN_COLOURS[k % len(CHAIN_COLOURS)],
            linestyle=CHAIN_DASHES[k % len(CHAIN_DASHES)],
            label=label,
        )
    axis.set_yscale("log")
    axis.set_ylim(1e-5, 1.5)
    axis.set_xlabel("row")
    axis.set_ylabel("$|I_1 - I_2| / (I_1 + I_2)$")
    figure.legend(loc="outside lower center", ncols=len(curves))  # the curves fill the axes
    return figure
