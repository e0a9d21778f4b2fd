"""The figure of a map: distance to equipartition and final amplitude over coupling, one line a number of chains."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import STYLE
from analysis.trajectory import Floats

DECAY_LENGTH = 2.709
"""n* kappa: where a pulse that leaves half the energy of its springs behind has spent itself (V = 1, two chains)."""


def map_figure(columns: dict[str, Floats]) -> Figure:
    """Distance (beads to 1%) and final amplitude over kappa.

    Args:
        columns: ``chains``, ``kappa``, ``ten``, ``one``, ``amplitude``, one number a case; NaN where there is none.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 4.0), layout="constrained")
        distance, amplitude = figure.subplots(1, 2)
        numbers = np.unique(columns["chains"])
        colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(numbers)))
        markers = "osD^v<>"
        for k, number in enumerate(numbers):
            here = columns["chains"] == number
            order = np.argsort(columns["kappa"][here])
            kappa = columns["kappa"][here][order]
            look = {"color": colours[k], "marker": markers[k % len(markers)], "markersize": 4}
            distance.plot(kappa, columns["one"][here][order], label=f"$N$ = {int(number)}", **look)
            distance.plot(kappa, columns["ten"][here][order], **{**look, "marker": "", "linestyle": ":"})
            reached = ~np.isnan(columns["ten"][here][order])
            amplitude.plot(kappa, columns["amplitude"][here][order], label=f"$N$ = {int(number)}", **look)
            amplitude.plot(
                kappa[~reached], columns["amplitude"][here][order][~reached], "x", color="black", markersize=6
            )
        kappa = np.geomspace(columns["kappa"].min(), columns["kappa"].max(), 50)
        distance.plot(kappa, DECAY_LENGTH / kappa, color="black", linewidth=1.0, linestyle=(0, (5, 2)))
        distance.text(kappa[34], DECAY_LENGTH / kappa[34], "decay law:\n$n^* = 2.709/\\kappa$  ", ha="right", va="top")
        for axis in (distance, amplitude):
            axis.set_xscale("log")
            axis.set_xlabel("coupling $\\kappa$ (at $V$ = 1)")
        distance.set_yscale("log")
        distance.set_ylabel("bead from which the chains agree")
        distance.set_title("distance to 1% (solid) and 10% (dotted)")
        amplitude.set_ylabel("mean leading peak / $V$")
        amplitude.set_title("amplitude at the end (x: not level there)")
        amplitude.set_ylim(bottom=0.0)
        amplitude.legend(ncols=2)
    return figure
