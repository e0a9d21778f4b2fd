"""Contacts that yield: largest force and permanent overlap along the chains."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.contacts import YieldTable
from analysis.figures.style import STYLE, axis_unit, chain_legend, draw_chain, letter, shown_chains, title
from analysis.trajectory import Floats
from lammps_inputs import Problem

LEAST = 1e-4
"""Share of the largest value below which none is drawn."""


@mpl.rc_context(STYLE)
def yield_figure(problem: Problem, table: YieldTable) -> Figure:
    """Over the number of the contact, on logarithmic axes."""
    force, length = (
        axis_unit(problem, "force", _most(table.force)),
        axis_unit(problem, "length", _most(table.permanent)),
    )
    figure = Figure(figsize=(7.0, 6.0), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True)
    for position, chain in enumerate(shown_chains(problem)):
        here = table.chain == chain + 1
        for axis, unit, values in ((axes[0], force, table.force), (axes[1], length, table.permanent)):
            noticed = values[here] > LEAST * _most(values)
            shown = np.where(noticed, values[here] * unit.worth, np.nan)
            draw_chain(axis, position, chain, table.contact[here], shown)
    for axis, unit, name in ((axes[0], force, "force"), (axes[1], length, "permanent")):
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylabel(unit.label(YieldTable, name))
    letter(tuple(axes))
    axes[1].set_xlabel("contact")
    figure.suptitle(title(problem, each_chain=True))
    chain_legend(figure, axes[0])
    return figure


def _most(values: Floats) -> float:
    return float(np.max(values)) or 1.0
