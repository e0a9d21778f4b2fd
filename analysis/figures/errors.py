"""Errors of a validation over space, time and tolerances; traces beside data."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from analysis.compare.difference import Deviation, ErrorMap
from analysis.figures.drawing import draw
from analysis.figures.panels import Axis, Curve, FrameContent, Marks, Panel, Sheet, axis_unit, evenly_spaced, title
from analysis.figures.style import CHAIN_COLOURS, head, is_narrow, letter, name_columns, new_figure, styled
from analysis.files.traces import Traces
from analysis.trajectory import Floats
from lammps_inputs import Problem
from lammps_inputs.units import Label

GOOD, BAD = "#0072B2", "#D55E00"

DECADES = 1e-6
"""Errors that much below the largest are drawn like nothing."""


@styled
def validation_figure(
    problem: Problem, errors: ErrorMap, deviations: dict[str, Deviation], tolerances: dict[str, float], against: str
) -> Figure:
    """Largest velocity error of any chain over bead and time; beside it, every quantity as a share of its tolerance.

    Beads that are not evenly spaced stand side by side in columns of one width.

    Args:
        problem: what was run.
        errors: see `analysis.compare.difference.Difference.error_map`.
        deviations, tolerances: by quantity, dimensionless.
        against: name of what the run was compared with.
    """
    figure = new_figure(7.0 if is_narrow() else 3.8, 8.0)
    space, points = (
        figure.subplots(2, 1, height_ratios=(1.6, 1.0))
        if is_narrow()
        else figure.subplots(1, 2, width_ratios=(1.6, 1.0))
    )
    _draw_map(figure, space, problem, errors)
    _draw_shares(points, deviations, tolerances)
    letter((space, points))
    head(figure, f"{problem.name}: against {against}")
    return figure


def _draw_map(figure: Figure, space: Axes, problem: Problem, errors: ErrorMap) -> None:
    finite = errors.velocity[np.isfinite(errors.velocity)]
    top = max(float(finite.max(initial=0.0)), 1e-15)
    shown = np.ma.masked_invalid(np.clip(errors.velocity, DECADES * top, None))
    last = errors.time[-1] if errors.time[-1] > errors.time[-2] else errors.time[-2] + problem.every
    unit = axis_unit(problem, "time", float(last))
    beads, edges = errors.bead[:-1], np.arange(len(errors.bead)) - 0.5
    even = evenly_spaced(beads)
    if even:  # a cell of several beads begins with its first
        step = beads[1] - beads[0]
        edges = np.append(beads, beads[-1] + step) - 0.5 * (step if errors.each else 1)
    image = space.pcolormesh(
        edges,
        np.append(errors.time[:-1], last) * unit.worth,
        shown,
        cmap="cividis",
        norm=LogNorm(DECADES * top, top),
        rasterized=True,
    )
    space.set_facecolor(BAD)  # shows where the error is not a number
    space.set_xlabel("bead")
    if not even:
        name_columns(space, beads)
    space.set_ylabel(unit.axis(FrameContent, "time").label.mathtext)
    beyond = "min" if np.any(finite < DECADES * top) else "neither"
    bar = figure.colorbar(image, ax=space, extend=beyond)
    bar.set_label(r"largest error of any chain $|v - v_\mathrm{ref}| / V$")


def _draw_shares(axis: Axes, deviations: dict[str, Deviation], tolerances: dict[str, float]) -> None:
    """A point for each quantity at its largest error over its tolerance; at an edge, and written, if 0 or infinite."""
    largest = np.array([deviation.largest for deviation in deviations.values()])
    limits = np.array([tolerances[name] for name in deviations])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        shares = np.where(largest == 0.0, 0.0, largest / limits)
    positive = (shares > 0.0) & np.isfinite(shares)
    low = min(1e-3, 0.5 * float(np.min(shares[positive], initial=1.0)))
    high = max(10.0, 2.0 * float(np.max(shares[positive], initial=1.0)))
    for row, share in enumerate(shares.tolist()):
        good = share <= 1.0
        look: dict[str, Any] = {
            "color": GOOD if good else BAD,
            "marker": "o" if good else "X",
            "markersize": 6,
            "clip_on": False,
        }
        at = float(np.clip(share if math.isfinite(share) else high, low, high))
        axis.plot([at], [row], linestyle="none", zorder=3, **look)
        if not positive[row]:
            axis.annotate(
                f"{share:g}",
                (at, row),
                (8 if share == 0.0 else -8, 0),
                textcoords="offset points",
                va="center",
                ha="left" if share == 0.0 else "right",
            )
    axis.set_yticks(range(len(shares)), labels=list(deviations))
    axis.set_ylim(len(shares) - 0.5, -0.5)
    axis.set_xscale("log")
    axis.set_xlim(low, high)
    axis.axvline(1.0, color="black", linewidth=1.0)
    axis.grid(True, axis="y", color="0.9", linewidth=0.6)
    axis.set_axisbelow(True)
    axis.set_xlabel("largest error / tolerance")


MOST_CHANNELS = 6

MOST_POINTS = 4000
"""Of a trace; of longer ones every second, every third, ..."""


def residual_figure(
    problem: Problem, measured: Traces, computed: Floats, size: Floats, unit: str = r"$\sigma$", mark: str = ""
) -> Figure:
    """Draw, for each channel (the first six), a panel with data and run, and one with their difference, data minus run.

    Args:
        problem: what was run, for its name and units.
        measured: traces of the data, [instant, channel], in the scene's units.
        computed: the run's traces, [instant, channel], in the scene's units.
        size: [channel] unit in which differences are drawn, in the scene's units.
        unit: name of that unit.
        mark: end of the title.

    Returns:
        The figure, of matplotlib.

    Examples:
        >>> time = np.linspace(0.0, 20.0, 101)
        >>> data = traces.Traces(time, (traces.Channel("velocity", 1, 5),), np.sin(time)[:, np.newaxis], units=False)
        >>> computed = 0.9 * data.values  # [instant, channel]
        >>> problem = granchain.load("one-chain").problem()
        >>> len(residual_figure(problem, data, computed, size=np.array([0.1])).axes)
        2
    """
    count, scale = min(len(measured.channels), MOST_CHANNELS), problem.scale
    thin = slice(None, None, max(1, len(measured.time) // MOST_POINTS))
    time = axis_unit(problem, "time", float(measured.time[-1]) / scale.time)
    at, x = measured.time[thin] / scale.time * time.worth, time.axis(FrameContent, "time")
    dots, line = {"linestyle": "none", "marker": ".", "markersize": 2}, {"color": CHAIN_COLOURS[0]}
    zero = (Marks([0.0], look={**line, "linewidth": 0.8}, level=True),)
    rows = []
    for place, channel in enumerate(measured.channels[:count]):
        values, scale_unit = measured.values[thin, place], float(getattr(scale, channel.quantity))
        axis = axis_unit(problem, channel.quantity, float(np.nanmax(np.abs(measured.values[:, place]))) / scale_unit)
        worth, run = axis.worth / scale_unit, computed[thin, place]
        both = (
            Curve("data", at, values * worth, look={**dots, "color": "0.6"}),
            Curve("run", at, run * worth, look=line),
        )
        left = Curve("residual", at, (values - run) / size[place], look={**dots, "color": "0.3"})
        words = channel.name.split("_")
        rows.append([Panel(x, Axis(Label(words[0], unit=axis.symbol)), both, " ".join(words))])
        rows.append([Panel(x, Axis(Label(f"residual\n/ {unit}")), (left,), marks=zero)])
    more = f"; {len(measured.channels) - count} more channels" if len(measured.channels) > count else ""
    heading = f"{title(problem)}\ndata and run{more}{mark}"
    each = 3.0 if is_narrow() else 2.2  # room for labels beside panels
    return draw(Sheet(heading, rows, 0.8 + each * count, heights=(2.0, 1.0) * count))
