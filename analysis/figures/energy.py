"""Energy of the chains over time."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import STYLE, axis_unit, chain_legend, draw_chain, shown_chains, title
from analysis.sharing.energies import Flow
from lammps_inputs import Problem


def energy_figure(problem: Problem, flow: Flow) -> Figure:
    """Share of the energy of each chain (those drawn in other figures too), its centre and its spread, over time."""
    time = axis_unit(problem, "time", float(flow.time[-1]))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 6.0), layout="constrained")
        share, place = figure.subplots(2, 1, sharex=True)
        for position, chain in enumerate(shown_chains(problem)):
            draw_chain(share, position, chain, flow.time * time.worth, flow.share[:, chain])
            draw_chain(place, position, chain, flow.time * time.worth, flow.centre[:, chain])
            near = (flow.centre[:, chain] - flow.spread[:, chain], flow.centre[:, chain] + flow.spread[:, chain])
            place.fill_between(
                flow.time * time.worth, *near, alpha=0.15, color=place.lines[-1].get_color(), linewidth=0
            )
        share.set_ylabel("share of the energy")
        share.set_ylim(0.0, max(1.0, 1.05 * float(np.nanmax(flow.share))))
        place.set_ylabel("centre of the energy (bead),\nband: its spread")
        place.set_xlabel(f"time $t$ ({time.symbol})")
        figure.suptitle(title(problem, each_chain=True, until=float(flow.time[-1])))
        chain_legend(figure, share)
    return figure
