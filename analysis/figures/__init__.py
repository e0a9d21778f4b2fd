"""Figures of a run: data in, matplotlib Figure out. Readable in print and by colour-blind eyes; nothing is saved."""

from analysis.figures.budget import budget_figure
from analysis.figures.dispersion import dispersion_figure
from analysis.figures.distance import distance_figure
from analysis.figures.energy import energy_figure
from analysis.figures.forces import force_figure
from analysis.figures.response import BeadHistory, response_figure
from analysis.figures.shape import shape_figure
from analysis.figures.spacetime import SpaceTime, spacetime_figure
from analysis.figures.spectra import spectra_figure
from analysis.figures.style import (
    CHAIN_COLOURS,
    CHAIN_DASHES,
    MAX_PANELS,
    STYLE,
    Unit,
    axis_unit,
    draw_chain,
    shown_chains,
    title,
)

__all__ = [
    "CHAIN_COLOURS",
    "CHAIN_DASHES",
    "MAX_PANELS",
    "STYLE",
    "BeadHistory",
    "SpaceTime",
    "Unit",
    "axis_unit",
    "budget_figure",
    "dispersion_figure",
    "distance_figure",
    "draw_chain",
    "energy_figure",
    "force_figure",
    "response_figure",
    "shape_figure",
    "shown_chains",
    "spacetime_figure",
    "spectra_figure",
    "title",
]
