"""How the chains share the pulse over the distance run: amplitude, energy, lag."""

from collections.abc import Callable
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import STYLE, axis_unit, chain_legend, draw_chain, shown_chains, title
from analysis.sharing.energies import EnergyShares
from analysis.sharing.equipartition import Sharing
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact

AGREED = 0.01

FEW = 3
"""Chains up to which the energy of each is drawn: whole chains swing to and fro, and more cannot be told apart."""


def distance_figure(problem: Problem, shared: Sharing, energies: EnergyShares, direction: int = 1) -> Figure:
    """Leading waves over the bead that they pass, one line per chain (of many, see `shown_chains`).

    From the top, each where there is something to draw: peak velocities in units of the kick, and the bead from which
    on they agree to 1%; shares of the energy in each wave, in all of them as measured, and as exact waves of their
    amplitudes would hold; shares of each whole chain (half of its springs' counted; two to `FEW` chains); arrival
    behind the chain that was hit.
    """
    panels: list[Callable[[Axes], None]] = [
        lambda axis: _draw_amplitude(axis, problem, shared),
        lambda axis: _draw_waves(axis, problem, shared, energies),
    ]
    if 1 < problem.chains <= FEW and np.any(np.isfinite(energies.chain)):
        panels.append(lambda axis: _draw_chains(axis, problem, shared, energies))
    if problem.chains > 1:
        panels.append(lambda axis: _draw_lag(axis, problem, shared))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 0.8 + 2.0 * len(panels)), layout="constrained")
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for panel, axis, letter in zip(panels, axes, "abcd", strict=False):
            panel(axis)
            axis.set_title(f"({letter})", loc="left")
        axes[-1].set_xlabel("bead" if direction > 0 else f"bead, counted from bead {problem.beads}")
        axes[-1].xaxis.get_major_locator().set_params(integer=True)
        chain_legend(figure, axes[0])
        figure.suptitle(title(problem, each_chain=True))
    return figure


def _draw_amplitude(axis: Axes, problem: Problem, shared: Sharing) -> None:
    for place, chain in enumerate(shown_chains(problem)):
        draw_chain(axis, place, chain, shared.bead.astype(np.float64), shared.amplitude[:, chain])
    axis.set_ylabel("peak velocity / $V$")
    axis.set_ylim(bottom=0.0)
    bead = shared.agrees_from(AGREED)
    if bead is not None:
        axis.axvline(bead, color="0.6", linewidth=0.8, zorder=0)
        axis.set_title(f"within 1% from bead {bead} on", loc="right", fontsize=8, color="0.3")


def _draw_waves(axis: Axes, problem: Problem, shared: Sharing, energies: EnergyShares) -> None:
    system = problem.system
    bead = shared.bead[energies.place].astype(np.float64)
    measured = bool(np.any(np.isfinite(energies.wave)))
    if measured and problem.chains > 1:
        for place, chain in enumerate(shown_chains(problem)):
            draw_chain(axis, place, chain, bead, energies.wave[:, chain])
    few: dict[str, Any] = {"marker": ".", "markersize": 4} if len(shared) <= FEW else {}
    lines = []
    if (
        not physics.gap(system) and physics.alike(system) and system.holds(Fact.SONIC_VACUUM)
    ):  # what runs down other beads, or with gaps, is no exact wave
        exact = np.sum(shared.wave_share, axis=1)
        lines += axis.plot(shared.bead, exact, color="0.65", linewidth=3.0, label="all waves, if exact", **few)
    if measured:
        lines += axis.plot(bead, np.sum(energies.wave, axis=1), color="black", linewidth=1.0, label="all waves")
    axis.set_ylabel("energy of waves / all")
    axis.set_ylim(0.0, 1.05)
    axis.legend(handles=lines, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0)


def _draw_chains(axis: Axes, problem: Problem, shared: Sharing, energies: EnergyShares) -> None:
    bead = shared.bead[energies.place].astype(np.float64)
    for place, chain in enumerate(shown_chains(problem)):
        draw_chain(axis, place, chain, bead, energies.chain[:, chain])
    axis.set_ylabel("energy of chains / all")
    axis.set_ylim(0.0, 1.05)


def _draw_lag(axis: Axes, problem: Problem, shared: Sharing) -> None:
    unit = axis_unit(problem, "time", float(np.nanmax(np.abs(shared.lag), initial=0.0)))
    for place, chain in enumerate(shown_chains(problem)):
        draw_chain(axis, place, chain, shared.bead.astype(np.float64), shared.lag[:, chain] * unit.worth)
    axis.set_ylabel(f"lag behind chain {shared.kicked + 1} ({unit.symbol})")
