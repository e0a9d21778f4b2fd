"""Energy over time: where that of a run is and what dashpots have dissipated, and the shares of the chains."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from analysis.conservation import Account
from analysis.figures.style import (
    CHAIN_DASHES,
    AxisUnit,
    FrameContent,
    axis_unit,
    draw_chains,
    finish,
    head,
    legend_beside,
    new_figure,
    shown_chains,
    styled,
    title,
)
from analysis.sharing.energies import Flow
from analysis.trajectory import Floats
from lammps_inputs import Problem
from lammps_inputs.units import REDUCED

_STORED = {
    "kinetic": "#0072B2",
    "contacts": "#56B4E9",
    "springs": "#009E73",
    "ground": "#F0E442",
    "walls": "#332288",
    "resonators": "#882255",
}
"""Okabe and Ito's palette and two of Tol's, with a hatch for what is dissipated."""

_WORDS = {"ground": "foundation and weights", "springs": "springs between chains"}
"""Names in the legend, of those that differ from the account's."""

_LOST = ("#D55E00", "#E69F00", "#CC79A7", "#999999", "#661100")

MOST_MODES = 6
"""That are drawn."""

_NOTICED = 1e-3
"""Share of all energy that a layer must once have to be drawn."""


@styled
def budget_figure(problem: Problem, account: Account) -> Figure:
    """Energy held, and above it energy dissipated, by where and by source, in layers; the energy input as a line.

    Where instants are too far apart to show how energy oscillates, moving means are drawn.
    """
    largest = account.most
    time, energy = axis_unit(problem, "time", float(account.time[-1])), axis_unit(problem, "energy", largest)
    colours = iter(_LOST)  # there are five at most
    stored, losses, energy_input, mean_over = budget_curves(account)
    layers = [(_WORDS.get(name, name), part, _STORED[name], "") for name, part in stored.items()]
    layers += [(name, part, next(colours), "////") for name, part in losses.items()]
    figure = new_figure(4.2)
    axis = figure.subplots()
    below, t = np.zeros_like(account.time), account.time * time.worth
    for name, part, colour, hatch in layers:
        above = below + part * energy.worth
        axis.fill_between(t, below, above, facecolor=colour, hatch=hatch, edgecolor="white", linewidth=0.0, label=name)
        below = above
    axis.plot(t, energy_input * energy.worth, color="black", label="energy input")
    axis.set_xlim(t[0], t[-1])
    least = min(0.0, float(np.min(energy_input)))  # a drive may begin by taking up energy
    axis.set_ylim(1.06 * least * energy.worth, 1.06 * float(np.max(energy_input)) * energy.worth)
    axis.set_xlabel(time.label(Account, "time"))
    axis.set_ylabel(energy.label(FrameContent, "energy") + _averaged(mean_over, time))
    head(figure, title(problem, until=float(account.time[-1])))
    handles, labels = axis.get_legend_handles_labels()
    legend_beside(figure, handles[::-1], labels[::-1], handleheight=1.4)  # as the layers lie
    return figure


class BudgetCurves(NamedTuple):
    """Energies of a budget, each [instant]; moving means over a duration in units of T, 0 where they are none."""

    stored: dict[str, Floats]
    losses: dict[str, Floats]
    energy_input: Floats
    mean_over: float

    @property
    def by_words(self) -> dict[str, Floats]:
        """Energies stored and dissipated, [instant] each, by their names in a legend."""
        return {_WORDS.get(name, name): part for name, part in (*self.stored.items(), *self.losses.items())}


def budget_curves(account: Account) -> BudgetCurves:
    """Curves of a budget that are large enough to be drawn.

    Where instants are too far apart to show how energy oscillates, they are moving means.
    """
    largest = account.most
    width = oscillations_to_average(account.kinetic, largest)
    stored, losses = (
        {name: moving_mean(part, width) for name, part in parts.items() if np.max(np.abs(part)) > _NOTICED * largest}
        for parts in (account.stored, account.losses)
    )
    return BudgetCurves(stored, losses, moving_mean(account.energy_input, width), _half_width(account.time, width))


@styled
def energy_figure(problem: Problem, flow: Flow) -> Figure:
    """Share of the energy of each chain (those drawn in other figures too), its centre and its spread, over time.

    Of rows on springs that vary, also the share of the action of each mode. Shares that no instant resolves are moving
    means; what is constant, as the share of a single chain, is left out.
    """
    time, chains = axis_unit(problem, "time", float(flow.time[-1])), shown_chains(problem)
    shares, centres = flow.share[:, chains], flow.centre[:, chains]
    kinds = [kind for kind, values in (("share", shares), ("centre", centres)) if _varies(values)]
    kinds += ["action"] * (flow.action is not None)
    kinds = kinds or ["centre"]
    figure = new_figure(max(2.8, 0.8 + 2.2 * len(kinds)))
    panels = figure.subplots(len(kinds), 1, sharex=True, squeeze=False)[:, 0]
    t = flow.time * time.worth
    for kind, panel in zip(kinds, panels, strict=True):
        if kind == "share":
            width = max(oscillations_to_average(share, 1.0) for share in shares.T)
            draw_chains(panel, chains, t, np.stack([moving_mean(share, width) for share in shares.T], axis=1))
            panel.set_ylabel("share of the energy" + _averaged(_half_width(flow.time, width), time))
            panel.set_ylim(0.0, max(1.0, 1.05 * float(np.nanmax(shares))))
        elif kind == "centre":
            draw_chains(panel, chains, t, centres)
            for line, chain in zip(panel.lines[: len(chains)], chains, strict=True):
                centre, spread = flow.centre[:, chain], flow.spread[:, chain]
                panel.fill_between(t, centre - spread, centre + spread, alpha=0.15, color=line.get_color(), linewidth=0)
            panel.set_ylabel("centre of the energy (bead),\nband: standard deviation")
        elif flow.action is not None:
            actions = flow.action.T[:MOST_MODES]
            greys = np.linspace(0.0, 0.6, len(actions))  # colours are the chains'
            for mode, (action, grey) in enumerate(zip(actions, greys, strict=True), 1):
                panel.plot(t, action, label=f"mode {mode}", linestyle=CHAIN_DASHES[mode - 1], color=str(grey))
            panel.set_ylabel("share of the action")
            panel.set_ylim(0.0, 1.05)
            panel.legend(title="slowest first", fontsize="small", title_fontsize="small")
    panels[-1].set_xlabel(time.label(Flow, "time"))
    finish(figure, problem, panels, until=float(flow.time[-1]))
    return figure


_CONSTANT = 1e-9
"""Largest change of what is constant."""


def _varies(values: Floats) -> bool:
    """Whether any curve [instant, chain] changes over time."""
    finite = values[np.isfinite(values).all(axis=1)]
    return len(finite) > 1 and bool(np.max(np.ptp(finite, axis=0)) > _CONSTANT)


RESOLVED = 8.0
"""Instants of an oscillation from which on a curve through them shows it."""

_SWING = 0.05
"""Share of the largest energy that a swing of an oscillation has at least."""

_AVERAGED = 6
"""Oscillations that a moving mean is over."""


def oscillations_to_average(values: Floats, largest: float) -> int:
    """Number of instants that a moving mean is over, so that oscillations of values [instant] vanish.

    0 where instants are near enough together to show them, or there are none of `_SWING` times the largest value.
    """
    change = np.diff(values[np.isfinite(values)])
    turns = np.flatnonzero(np.sign(change[1:]) != np.sign(change[:-1])) + 1
    swings = np.count_nonzero(np.abs(np.diff(values[np.isfinite(values)][turns])) > _SWING * largest)
    period = 2.0 * len(values) / swings if swings else np.inf
    if period >= RESOLVED:
        return 0
    return min(max(_LEAST_AVERAGED, math.ceil(_AVERAGED * period)), len(values) // 3)


_LEAST_AVERAGED = 16


def moving_mean(values: Floats, width: int) -> Floats:
    """Mean of the finite values [instant] over so many instants, weighted by a Hann window; values themselves for 0."""
    if not width:
        return values
    weight = np.hanning(width + 2)[1:-1]
    finite = np.isfinite(values)
    with np.errstate(invalid="ignore", divide="ignore"):
        total, weights = (np.convolve(part, weight, mode="same") for part in (np.nan_to_num(values), finite * 1.0))
        return np.asarray(total / weights)


def _half_width(time: Floats, width: int) -> float:
    """Duration of a Hann window of so many instants at half its height, in the units of ``time`` [instant]; or 0."""
    if not width:
        return 0.0
    return 0.5 * width * float(time[-1] - time[0]) / (len(time) - 1)


def _averaged(mean_over: float, unit: AxisUnit) -> str:
    """End of a label of moving means over a duration, in units of T; empty where there are none."""
    if not mean_over:
        return ""
    return f",\nmean over {mean_over * unit.worth:.2g}" + (f" {unit.symbol}" if unit.symbol != REDUCED else "")
