"""How the chains share the pulse over the distance run: amplitude, energy, lag."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.energy_shares import EnergyShares
from analysis.equipartition import Sharing
from analysis.figures.style import CHAIN_COLOURS, MAX_PANELS, STYLE, draw_chain, title, unit_label
from lammps_inputs import Problem

AGREED = 0.01

FEW = 3
"""Chains up to which the energy of each is drawn."""


def distance_figure(problem: Problem, shared: Sharing, energies: EnergyShares, direction: int = 1) -> Figure:
    """Leading waves over the bead that they pass, one line per chain (the first ones, where there are many).

    (a) Peak velocities in units of the kick, and the bead from which on they agree to 1%. (b) Shares of the energy:
    each chain's (half of its springs' counted; up to `FEW` chains), its wave's, all waves' as measured and as exact
    waves of their amplitudes would hold. (c) Arrival behind the chain that was hit.
    """
    chains = min(problem.chains, MAX_PANELS)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 7.2), layout="constrained")
        amplitude, energy, lag = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 1.25, 0.8))
        bead = shared.bead.astype(np.float64)
        for chain in range(chains):
            draw_chain(amplitude, chain, bead, shared.amplitude[:, chain])
            draw_chain(lag, chain, bead, shared.lag[:, chain] * problem.scale.time)
        amplitude.set_ylabel("peak velocity / $V$")
        amplitude.set_ylim(bottom=0.0)
        _mark_agreement(amplitude, shared)
        amplitude.legend(loc="upper right", ncols=min(chains, 4))
        _draw_energy(energy, shared, energies, chains)
        lag.set_ylabel(f"behind chain {shared.kicked + 1} ({unit_label(problem, 'time')})")
        lag.set_xlabel("bead" if direction > 0 else f"bead, counted from bead {problem.beads}")
        for axis, letter in zip((amplitude, energy, lag), "abc", strict=True):
            axis.set_title(f"({letter})", loc="left")
        figure.suptitle(title(problem, each_chain=True))
    return figure


def _draw_energy(axis: Axes, shared: Sharing, energies: EnergyShares, chains: int) -> None:
    bead = shared.bead[energies.place]
    dotted, dashed = (0, (1, 1)), (0, (5, 2))
    lines = []
    if len(bead):
        for chain in range(chains):  # whole chains swing to and fro: of many, only the waves can be told apart
            colour = CHAIN_COLOURS[chain % len(CHAIN_COLOURS)]
            if chains <= FEW:
                axis.plot(bead, energies.chain[:, chain], color=colour)
            axis.plot(bead, energies.wave[:, chain], color=colour, linestyle=dotted)
        if chains <= FEW:
            lines.append(Line2D([], [], color=CHAIN_COLOURS[0], label="a whole chain"))
        lines.append(Line2D([], [], color=CHAIN_COLOURS[0], linestyle=dotted, label="a chain's wave"))
        lines += axis.plot(bead, np.sum(energies.wave, axis=1), color="black", label="all waves")
    total = np.sum(shared.wave_share, axis=1)
    lines += axis.plot(shared.bead, total, color="0.55", linestyle=dashed, label="all waves, if exact")
    axis.set_ylabel("share of the energy")
    axis.set_ylim(0.0, 1.05)
    axis.legend(handles=lines, loc="upper right", ncols=2)


def _mark_agreement(axis: Axes, shared: Sharing) -> None:
    bead = shared.agrees_from(AGREED)
    if bead is None:
        return
    axis.axvline(bead, color="0.6", linewidth=0.8, zorder=0)
    late = bead > 0.6 * shared.bead[-1]
    axis.annotate(
        f"within 1% from bead {bead} on",
        (bead, 0.0),
        xytext=(-4 if late else 4, 4),
        textcoords="offset points",
        ha="right" if late else "left",
        fontsize=8,
        color="0.3",
    )
