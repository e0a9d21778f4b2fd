"""One panel in the style of all figures."""

from collections.abc import Callable
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import CHAIN_COLOURS, STYLE

COLOURS = CHAIN_COLOURS
PUBLISHED: dict[str, Any] = {"color": "0.45", "linewidth": 1.0, "linestyle": (0, (4, 2))}
"""How what was published is drawn."""


def panel(x: str, y: str, draw: Callable[[Axes], None]) -> Figure:
    """A figure of one panel with labelled axes and a legend; ``draw`` fills it."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 3.4), layout="constrained")
        axis = figure.subplots()
        draw(axis)
        axis.set_xlabel(x)
        axis.set_ylabel(y)
        if axis.get_legend_handles_labels()[1]:
            axis.legend()
    return figure
