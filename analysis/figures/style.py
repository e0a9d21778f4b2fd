"""What all figures share: colours, dashes, sizes, labels."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.trajectory import Floats
from lammps_inputs import Problem

CHAIN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's palette, ordered for contrast between the first few."""

CHAIN_DASHES: tuple[object, ...] = (
    "-",
    (0, (4, 1.5)),
    (0, (1, 1)),
    (0, (5, 1, 1, 1)),
    (0, (8, 2)),
    (0, (3, 1, 1, 1, 1, 1)),
    (0, (1, 2.5)),
    (0, (8, 2, 2, 2)),
)
"""One for each chain of a figure, so that chains can be told apart in grey."""

MAX_PANELS = 8
"""Chains that a figure shows at most, see `shown_chains`."""

FEW_NUMBERS = 20

STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "figure.titlesize": 10,
    "lines.linewidth": 1.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""Settings of matplotlib for every figure (its own type lists some hundred keys)."""


@dataclass(frozen=True)
class Unit:
    """The unit of an axis.

    Attributes:
        worth: of one dimensionless unit, in it.
        symbol: such as ``ms``; ``reduced`` for reduced units.
    """

    worth: float
    symbol: str


def axis_unit(problem: Problem, quantity: str, largest: float) -> Unit:
    """A unit in which an axis needs no powers of ten: s, ms, us, ns, likewise m/s; reduced units as they are.

    Args:
        problem: what is drawn.
        quantity: ``time``, ``velocity``, ``length`` or ``force``.
        largest: size of the largest number on the axis, dimensionless.
    """
    worth = float(getattr(problem.scale, quantity))
    size = abs(largest) * worth
    power = math.floor(math.log10(size) / 3.0) if 0.0 < size < math.inf else 0
    if not problem.scale.si:
        if -1 <= power <= 1:
            return Unit(worth, "reduced")
        return Unit(worth / 10.0 ** (3 * power), f"$10^{{{3 * power}}}$ reduced")
    power = min(max(power, min(_PREFIXES)), 0 if quantity == "time" else 1)
    return Unit(worth / 10.0 ** (3 * power), _PREFIXES[power] + problem.scale.symbol(quantity))


_PREFIXES = {1: "k", 0: "", -1: "m", -2: "\N{MICRO SIGN}", -3: "n", -4: "p"}


def shown_chains(problem: Problem) -> list[int]:
    """Chains that a figure shows, counted from 0, ascending: all, or those that were hit and some far from those.

    Of more than `MAX_PANELS`, first the ones that were hit (the hardest first), then always the one farthest from all
    chosen so far.
    """
    if problem.chains <= MAX_PANELS:
        return list(range(problem.chains))
    by_kick = sorted(problem.kicks, key=lambda kick: -abs(kick[2]))
    chosen = list(dict.fromkeys(chain - 1 for chain, _, _ in by_kick))[:MAX_PANELS]
    while len(chosen) < MAX_PANELS:
        distance = np.min(np.abs(np.arange(problem.chains)[:, None] - chosen), axis=1)
        chosen.append(int(np.argmax(distance)))
    return sorted(chosen)


def title(problem: Problem, *, each_chain: bool = False, until: float | None = None) -> str:
    """Name and numbers of a scene, for the top of a figure.

    Args:
        problem: what was run.
        each_chain: whether the figure shows each chain; of many it then says which ones.
        until: time of the last frame there is, in units of T; of a run that was cut short it is said.
    """
    coupled = f", $\\kappa$ = {problem.kappa:.4g}" if problem.coupled else ""
    gap = ""
    if problem.gap:
        unit = axis_unit(problem, "length", problem.gap)
        gap = f", gap {problem.gap * unit.worth:.4g}" + (f" {unit.symbol}" if problem.scale.si else "")
    cut = ""
    if until is not None and until < problem.duration - 0.5 * problem.every:
        cut = f"; cut short at {until / problem.duration:.0%} of its time"
    shown = ""
    if each_chain and problem.chains > MAX_PANELS:
        shown = f" (chains {', '.join(str(chain + 1) for chain in shown_chains(problem))} are shown)"
    return f"{problem.name}: $N$ = {problem.chains}{shown}{coupled}{gap}{cut}"


def chain_look(place: int) -> dict[str, Any]:
    """Colour and dash of the chain in a place, from 0, among those that a figure shows."""
    return {"color": CHAIN_COLOURS[place % len(CHAIN_COLOURS)], "linestyle": CHAIN_DASHES[place % len(CHAIN_DASHES)]}


def draw_chain(axis: Axes, place: int, chain: int, x: Floats, y: Floats) -> None:
    """One line in the look of a chain (counted from 0) in a place; with marks where there are few numbers."""
    axis.plot(
        x,
        y,
        **chain_look(place),
        marker="o" if len(x) <= FEW_NUMBERS else None,
        markersize=4,
        label=f"chain {chain + 1}",
    )


def chain_legend(figure: Figure, axis: Axes) -> None:
    """The chains of an axis in a row below the figure, where no curve is; none for a single chain."""
    handles, labels = axis.get_legend_handles_labels()
    if len(handles) > 1:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(handles), 4))
