"""What all figures share: colours, dashes, sizes, labels."""

from typing import Any

from matplotlib.axes import Axes

from analysis.trajectory import Floats
from lammps_inputs import Problem

CHAIN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's palette, ordered for contrast between the first few."""

CHAIN_DASHES: tuple[object, ...] = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (5, 1, 1, 1)))

MAX_PANELS = 8
"""Chains that a figure shows; of more, the first."""

FEW_NUMBERS = 20

STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "figure.titlesize": 10,
    "lines.linewidth": 1.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""Settings of matplotlib for every figure (its own type lists some hundred keys)."""


def unit_label(problem: Problem, quantity: str) -> str:
    """The unit of a quantity on an axis of this scene."""
    return problem.scale.symbol(quantity) if problem.scale.si else "reduced"


def title(problem: Problem, *, each_chain: bool = False) -> str:
    """Name and numbers of a scene, for the top of a figure; which chains it shows where it shows each."""
    coupled = f", $\\kappa$ = {problem.kappa:.4g}" if problem.coupled else ""
    gap = f", gap {problem.gap:.4g}" if problem.gap else ""
    shown = f" (chains 1 to {MAX_PANELS} are shown)" if each_chain and problem.chains > MAX_PANELS else ""
    return f"{problem.name}: $N$ = {problem.chains}{shown}{coupled}{gap}"


def draw_chain(axis: Axes, chain: int, x: Floats, y: Floats) -> None:
    """One line in the colour and dash of a chain (counted from 0); with marks where there are few numbers."""
    axis.plot(
        x,
        y,
        color=CHAIN_COLOURS[chain % len(CHAIN_COLOURS)],
        linestyle=CHAIN_DASHES[chain % len(CHAIN_DASHES)],
        marker="o" if len(x) <= FEW_NUMBERS else None,
        markersize=4,
        label=f"chain {chain + 1}",
    )
