"""Where the energy of a run is over time, and what dashpots have taken."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.conservation import Account
from analysis.figures.style import STYLE, axis_unit, title
from lammps_inputs import Problem

_HELD = {"kinetic": "#0072B2", "contacts": "#56B4E9", "springs": "#009E73", "ground": "#F0E442", "walls": "#332288"}
"""Okabe and Ito's palette and one of Tol's, as for what is lost; a hatch tells that from what is still there."""

_LOST = ("#D55E00", "#E69F00", "#CC79A7", "#999999")

_NOTICED = 1e-3
"""Share of all energy that a layer must once have to be drawn."""


def budget_figure(problem: Problem, account: Account) -> Figure:
    """Energy held, and above it energy lost, by where and by source, in layers; what was put in as a line."""
    most = account.most
    time, energy = axis_unit(problem, "time", float(account.time[-1])), axis_unit(problem, "energy", most)
    layers = [(name, account.held[name], colour, "") for name, colour in _HELD.items()]
    lost = zip(account.losses.items(), _LOST, strict=False)  # there are four at most
    layers += [(name, part, colour, "////") for (name, part), colour in lost]
    with mpl.rc_context({**STYLE, "hatch.linewidth": 0.6}):
        figure = Figure(figsize=(7.0, 4.2), layout="constrained")
        axis = figure.subplots()
        below, t = np.zeros_like(account.time), account.time * time.worth
        for name, part, colour, hatch in layers:
            if np.max(np.abs(part)) <= _NOTICED * most:
                continue
            above = below + part * energy.worth
            axis.fill_between(
                t, below, above, facecolor=colour, hatch=hatch, edgecolor="white", linewidth=0.0, label=name
            )
            below = above
        axis.plot(t, account.put_in * energy.worth, color="black", label="put in")
        axis.set_xlim(t[0], t[-1])
        least = min(0.0, float(np.min(account.put_in)))  # a drive may begin by taking up energy
        axis.set_ylim(1.06 * least * energy.worth, 1.06 * most * energy.worth)
        axis.set_xlabel(f"time $t$ ({time.symbol})")
        axis.set_ylabel(f"energy ({energy.symbol})")
        figure.suptitle(title(problem, until=float(account.time[-1])))
        handles, labels = axis.get_legend_handles_labels()
        figure.legend(handles[::-1], labels[::-1], loc="outside right center", handleheight=1.4)  # as the layers lie
    return figure
