"""How equally two chains of gapped beads share a pulse: over the gap (rigid beads), and along the chain (both)."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.figures.style import CHAIN_COLOURS, CHAIN_DASHES, STYLE
from analysis.trajectory import Floats


def scan_figure(theta: Floats, differences: Floats, rows: Sequence[int], agree: float) -> Figure:
    """Difference of the chains' first impulses over theta, a panel for each row.

    Args:
        theta: omega D / V, [theta].
        differences: (largest - smallest) / mean, [theta, row].
        rows: numbers of the rows.
        agree: below which chains count as equal; drawn as a line.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 1.0 + 1.7 * len(rows)), layout="constrained")
        axes = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
        for axis, row, difference in zip(axes, rows, differences.T, strict=True):
            axis.plot(theta, np.maximum(difference, 1e-4), ".", markersize=2, color=CHAIN_COLOURS[0])
            axis.axhline(agree, color="black", linewidth=0.8)
            axis.set_yscale("log")
            axis.set_ylim(8e-5, 3.0)
            axis.set_title(f"row {row}", loc="left")
        figure.supylabel("difference of the chains' first impulses / mean")
        axes[-1].set_xlabel(r"$\theta = \omega D / V$")
    return figure


def relative_mode_figure(curves: Sequence[tuple[str, NDArray[np.int64], Floats]]) -> Figure:
    """|I1 - I2| / (I1 + I2) of first impulses along the chains.

    Args:
        curves: label, row numbers and values of each model.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 3.6), layout="constrained")
        axis = figure.subplots()
        for k, (label, bead, difference) in enumerate(curves):
            axis.plot(
                bead,
                np.abs(difference),
                color=CHAIN_COLOURS[k % len(CHAIN_COLOURS)],
                linestyle=CHAIN_DASHES[k % len(CHAIN_DASHES)],
                label=label,
            )
        axis.set_yscale("log")
        axis.set_ylim(1e-5, 1.5)
        axis.set_xlabel("row")
        axis.set_ylabel("$|I_1 - I_2| / (I_1 + I_2)$")
        figure.legend(loc="outside lower center", ncols=len(curves))  # the curves fill the axes
    return figure
