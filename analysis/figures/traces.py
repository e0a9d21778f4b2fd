"""Measured traces beside those of a run, and their residuals."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import CHAIN_COLOURS, STYLE, axis_unit
from analysis.files.traces import Traces
from analysis.trajectory import Floats
from lammps_inputs import Problem

MOST_CHANNELS = 6

MOST_POINTS = 4000
"""Of a trace; of longer ones every second, every third, ..."""


def residual_figure(
    problem: Problem, given: Traces, found: Floats, size: Floats, unit: str = "sigma", mark: str = ""
) -> Figure:
    """For each channel (the first six) a panel with data and run, and one with their difference, data minus run.

    Args:
        problem: for name and units.
        given: the data.
        found: the run's traces, [row, channel], in the scene's units.
        size: [channel] what differences are drawn in units of.
        unit: what that is called.
        mark: what the title ends in.
    """
    count = min(len(given.channels), MOST_CHANNELS)
    thin = slice(None, None, max(1, len(given.time) // MOST_POINTS))
    scale = problem.scale
    time = axis_unit(problem, "time", float(given.time[-1]) / scale.time)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 0.8 + 2.2 * count), layout="constrained")
        axes = figure.subplots(2 * count, 1, sharex=True, squeeze=False, height_ratios=[2, 1] * count)[:, 0]
        for place, channel in enumerate(given.channels[:count]):
            own = float(getattr(scale, channel.quantity))
            axis = axis_unit(problem, channel.quantity, float(np.nanmax(np.abs(given.values[:, place]))) / own)
            at, worth = given.time[thin] / scale.time * time.worth, axis.worth / own
            traces, left = axes[2 * place], axes[2 * place + 1]
            traces.plot(at, given.values[thin, place] * worth, ".", color="0.6", markersize=2, label="data")
            traces.plot(at, found[thin, place] * worth, color=CHAIN_COLOURS[0], label="run")
            traces.set_ylabel(f"{channel.name.replace('_', ' ')}\n({axis.symbol})", fontsize=8)
            left.plot(at, ((given.values - found)[:, place] / size[place])[thin], ".", color="0.3", markersize=2)
            left.axhline(0.0, color=CHAIN_COLOURS[0], linewidth=0.8)
            left.set_ylabel(f"residual\n/ {unit}", fontsize=8)
        axes[-1].set_xlabel(f"time ({time.symbol})")
        axes[0].legend(loc="upper right")
        more = f"; {len(given.channels) - count} more channels" if len(given.channels) > count else ""
        figure.suptitle(f"{problem.name}: data and run{more}{mark}")
    return figure
