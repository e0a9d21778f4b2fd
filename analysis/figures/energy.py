"""Energy over time: where that of a run is and what dashpots have dissipated, and the shares of the chains."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.conservation import Account
from analysis.figures.style import STYLE, Frames, axis_unit, draw_chains, finish, shown_chains, title
from analysis.sharing.energies import Flow
from lammps_inputs import Problem

_STORED = {
    "kinetic": "#0072B2",
    "contacts": "#56B4E9",
    "springs": "#009E73",
    "ground": "#F0E442",
    "walls": "#332288",
    "resonators": "#882255",
}
"""Okabe and Ito's palette and two of Tol's, with a hatch for what is dissipated."""

_LOST = ("#D55E00", "#E69F00", "#CC79A7", "#999999", "#661100")

MOST_MODES = 6
"""That are drawn."""

_NOTICED = 1e-3
"""Share of all energy that a layer must once have to be drawn."""


@mpl.rc_context({**STYLE, "hatch.linewidth": 0.6})
def budget_figure(problem: Problem, account: Account) -> Figure:
    """Energy held, and above it energy lost, by where and by source, in layers; the energy input as a line."""
    most = account.most
    time, energy = axis_unit(problem, "time", float(account.time[-1])), axis_unit(problem, "energy", most)
    layers = [(name, account.stored[name], colour, "") for name, colour in _STORED.items()]
    lost = zip(account.losses.items(), _LOST, strict=False)  # there are five at most
    layers += [(name, part, colour, "////") for (name, part), colour in lost]
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axis = figure.subplots()
    below, t = np.zeros_like(account.time), account.time * time.worth
    for name, part, colour, hatch in layers:
        if np.max(np.abs(part)) <= _NOTICED * most:
            continue
        above = below + part * energy.worth
        axis.fill_between(t, below, above, facecolor=colour, hatch=hatch, edgecolor="white", linewidth=0.0, label=name)
        below = above
    axis.plot(t, account.energy_input * energy.worth, color="black", label="energy input")
    axis.set_xlim(t[0], t[-1])
    least = min(0.0, float(np.min(account.energy_input)))  # a drive may begin by taking up energy
    axis.set_ylim(1.06 * least * energy.worth, 1.06 * most * energy.worth)
    axis.set_xlabel(time.label(Account, "time"))
    axis.set_ylabel(energy.label(Frames, "energy"))
    figure.suptitle(title(problem, until=float(account.time[-1])))
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles[::-1], labels[::-1], loc="outside right center", handleheight=1.4)  # as the layers lie
    return figure


@mpl.rc_context(STYLE)
def energy_figure(problem: Problem, flow: Flow) -> Figure:
    """Share of the energy of each chain (those drawn in other figures too), its centre and its spread, over time.

    Of rows on springs that vary, also the share of the action of each mode.
    """
    time = axis_unit(problem, "time", float(flow.time[-1]))
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    panels = figure.subplots(2 if flow.action is None else 3, 1, sharex=True)
    share, place, *more = panels
    t, chains = flow.time * time.worth, shown_chains(problem)
    draw_chains(share, chains, t, flow.share[:, chains])
    draw_chains(place, chains, t, flow.centre[:, chains])
    for line, chain in zip(place.lines, chains, strict=True):
        centre, spread = flow.centre[:, chain], flow.spread[:, chain]
        place.fill_between(t, centre - spread, centre + spread, alpha=0.15, color=line.get_color(), linewidth=0)
    share.set_ylabel("share of the energy $E_n / E$")
    share.set_ylim(0.0, max(1.0, 1.05 * float(np.nanmax(flow.share))))
    place.set_ylabel("centre of the energy (bead),\nband: standard deviation")
    for axis, actions in zip(more, () if flow.action is None else (flow.action,), strict=True):
        for mode, action in enumerate(actions.T[:MOST_MODES], 1):
            axis.plot(t, action, label=f"mode {mode}", linewidth=1.0)
        axis.set_ylabel("share of the action")
        axis.set_ylim(0.0, 1.0)
        axis.legend(title="slowest first", fontsize="small", title_fontsize="small")
    panels[-1].set_xlabel(time.label(Flow, "time"))
    finish(figure, problem, panels, until=float(flow.time[-1]))
    return figure
