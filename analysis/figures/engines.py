"""Figure of several engines' runs of one scene: impulses along the chains, and velocities of a few rows."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.figures.style import CHAIN_COLOURS, MAX_PANELS, STYLE, unit_label
from analysis.trajectory import Floats
from lammps_inputs import Problem

ENGINE_DASHES: tuple[object, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)))
ENGINE_MARKERS = ("o", "x", "+")
MOST_ROWS = 3


@dataclass(frozen=True)
class Curve:
    """One engine's results, dimensionless.

    Attributes:
        engine: its name.
        time, velocity: of the shown rows, [frame] and [frame, chain, shown row].
        bead, first: numbers of the struck beads, and impulse of their first contact, [row] and [chain, row].
    """

    engine: str
    time: Floats
    velocity: Floats
    bead: NDArray[np.int64]
    first: Floats


def engines_figure(problem: Problem, rows: Sequence[int], curves: Sequence[Curve]) -> Figure:
    """First impulses of all rows above, one panel an engine; below the velocities of up to three rows.

    Below, a colour is a chain and a dash an engine.
    """
    scale, chains = problem.scale, min(problem.chains, MAX_PANELS)
    few = len(rows) <= MOST_ROWS
    chosen = list(range(len(rows))) if few else [1, len(rows) // 2, len(rows) - 1]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.5, 2.6 + 1.8 * len(chosen)), layout="constrained")
        grid = figure.add_gridspec(1 + len(chosen), len(curves), height_ratios=[1.3] + [1.0] * len(chosen))
        first = None
        for column, curve in enumerate(curves):
            first = figure.add_subplot(grid[0, column], sharey=first)
            for chain in range(chains):
                struck = np.where(curve.first[chain] > 0.0, curve.first[chain], np.nan)
                first.plot(curve.bead, struck, ".", ms=3, color=_colour(chain), label=f"chain {chain + 1}")
            first.set_title(curve.engine, loc="left")
            first.set_xlabel("bead")
            if column == 0:
                first.set_ylabel("first impulse / $mV$")
                first.legend(loc="center", markerscale=2)
            first.set_xlim(0, problem.beads + 1)
        for line, position in enumerate(chosen, 1):
            axis = figure.add_subplot(grid[line, :])
            for number, curve in enumerate(curves):
                dash = ENGINE_DASHES[number % len(ENGINE_DASHES)]
                for chain in range(chains):
                    values = curve.velocity[:, chain, position] * scale.velocity
                    label = curve.engine if chain == 0 else None
                    axis.plot(curve.time * scale.time, values, color=_colour(chain), linestyle=dash, label=label)
            axis.set_xlim(*_window(curves, position, scale.time))
            axis.set_title(f"bead {rows[position]}", loc="left")
            axis.set_ylabel(f"$v$ ({unit_label(problem, 'velocity')})")
            if line == 1:
                axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(curves))
        axis.set_xlabel(f"time $t$ ({unit_label(problem, 'time')})")
        coupled = f", $\\kappa$ = {problem.kappa:.4g}" if problem.coupled else ""
        gap = f", gap {problem.gap:.4g}" if problem.gap else ""
        figure.suptitle(f"{problem.name}: $N$ = {problem.chains}{coupled}{gap}")
    return figure


def _colour(chain: int) -> str:
    return CHAIN_COLOURS[chain % len(CHAIN_COLOURS)]


def _window(curves: Sequence[Curve], position: int, unit: float) -> tuple[float, float]:
    """The time in which the pulse passes a row in any engine: from the first motion to the last of half the largest."""
    moving = []
    for curve in curves:
        size = np.abs(curve.velocity[:, :, position]).max(axis=1)
        if size.max() > 1e-2:
            moving += [curve.time[np.argmax(size > 1e-2)], curve.time[np.flatnonzero(size > 0.5 * size.max())[-1]]]
    low, high = (min(moving), max(moving)) if moving else (0.0, float(curves[0].time[-1]))
    margin = 0.15 * (high - low) + 0.5
    return max(0.0, low - margin) * unit, min(high + margin, float(curves[0].time[-1])) * unit
