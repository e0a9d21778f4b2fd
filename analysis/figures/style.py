"""What all figures share: colours, dashes, sizes, labels, units, and how one becomes the content of a file.

Plug-ins take this module so that their figures look like the others: a function that draws is `styled`, begins with
`new_figure`, takes colours from `CHAIN_COLOURS` and units from `axis_unit`, and ends with `letter`, `head` and
`legend_below`. `title` names a run, `picture` gives the content of a file.

Examples:
    >>> problem = granchain.load("one-chain").problem()
    >>> @style.styled
    ... def speeds(beads, values):
    ...     figure = style.new_figure(2.5, 4.0)
    ...     figure.subplots().plot(beads, values, color=style.CHAIN_COLOURS[0])
    ...     style.head(figure, style.title(problem))
    ...     return figure
    >>> style.picture(speeds([10, 20], [0.62, 0.58]), "png", dpi=30)[1:4]
    b'PNG'
    >>> style.title(problem)
    'one-chain: 1 chain of 120 beads, $V$ = 1'
"""

import functools
import io
import math
import re
import string
import textwrap
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from analysis.figures.paper import NARROW, WIDTH
from analysis.quantity import declare, declared, result
from analysis.trajectory import Floats, Integers
from lammps_inputs import Problem, laws, physics
from lammps_inputs.laws import spring
from lammps_inputs.units import SI, Label, prefix, thousands

CHAIN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#882255", "#7F7F7F")
"""Okabe and Ito's palette, ordered for contrast between the first few; wine (Tol) and grey."""

CHAIN_DASHES: tuple[object, ...] = (
    "-",
    (0, (4, 1.5)),
    (0, (1, 1)),
    (0, (5, 1, 1, 1)),
    (0, (8, 2)),
    (0, (3, 1, 1, 1, 1, 1)),
    (0, (1, 2.5)),
    (0, (8, 2, 2, 2)),
    (0, (8, 1, 1, 1, 1, 1)),
)
"""One for each chain of a figure, so that chains can be distinguished in grey."""

MAX_PANELS = 9
"""Chains that a figure shows at most, see `shown_chains`."""

MAX_PANELS_OF_LATTICE = 25
"""Likewise of a lattice, where each chain has a panel of its own, which stands as the chain does."""

FEW_NUMBERS = 20

_MOST_LABELS = 8

STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titley": 1.0,  # there, and not sought for, which takes as long as all else
    "figure.titlesize": 10,
    "lines.linewidth": 1.3,
    "hatch.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.use_mathtext": True,
    "legend.frameon": False,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""Settings of matplotlib for every figure (its own type lists some hundred keys)."""

_LEGEND_ROW = 0.2
"""Inches."""

_NARROW: Any = {"font.size": 8, "axes.titlesize": 8, "lines.linewidth": 1.0, "lines.markersize": 4}
"""Those of a figure as wide as one column of a journal."""

Parameters = ParamSpec("Parameters")
Drawn = TypeVar("Drawn")


def styled(draw: Callable[Parameters, Drawn]) -> Callable[Parameters, Drawn]:
    """A function that draws, with the settings of every figure and those of the width that is asked for."""

    @functools.wraps(draw)
    def in_style(*arguments: Parameters.args, **options: Parameters.kwargs) -> Drawn:
        with settings():
            return draw(*arguments, **options)

    return in_style


def settings() -> AbstractContextManager[None]:
    """Context in which what is drawn has the settings of every figure and those of the width that is asked for."""
    return mpl.rc_context({**STYLE, **(_NARROW if is_narrow() else {})})


def is_narrow() -> bool:
    """Whether figures are asked for that are as wide as one column of a journal."""
    width = WIDTH.get()
    return width is not None and width < NARROW


def new_figure(height: float, width: float = 7.0) -> Figure:
    """An empty figure, of the width that is asked for (`WIDTH`) if there is one, and then less high or higher.

    Args:
        height: in inches.
        width: in inches, where none is asked for.

    Returns:
        The figure, of matplotlib, whose layout makes room for all that it gets.
    """
    column = WIDTH.get()
    size = (width, height) if column is None else (column, height * math.sqrt(column / width))
    return Figure(figsize=size, layout="constrained")


def head(figure: Figure, text: str) -> None:
    """Write a title, but where a width is asked for: a journal has captions.

    Args:
        figure: figure whose panels are drawn.
        text: one line or several; long ones are broken.
    """
    if WIDTH.get() is None:
        figure.suptitle("\n".join(_wrapped(line, figure.get_figwidth()) for line in text.splitlines()))


def legend_below(figure: Figure, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """Put a legend below the panels, where it hides no curve, in as few rows as fit; the figure grows by these.

    Args:
        figure: figure whose panels are drawn.
        handles: curves and marks of matplotlib.
        labels: words of each of them.
    """
    if not handles:
        return
    inches = 0.5 + 0.06 * max(map(len, labels))  # of a column: a letter has about half its height of 9 points
    rows = math.ceil(len(handles) / max(1, int(figure.get_figwidth() / inches)))
    figure.set_figheight(figure.get_figheight() + _LEGEND_ROW * rows)
    figure.legend(handles, labels, loc="outside lower center", ncols=math.ceil(len(handles) / rows))


def legend_beside(figure: Figure, handles: Sequence[Any], labels: Sequence[str], **options: Any) -> None:
    """Put a legend to the right of the panels, below them in a narrow figure."""
    if is_narrow():
        legend_below(figure, handles, labels)
    else:
        figure.legend(handles, labels, loc="outside right center", **options)


def label_log_axis(setting: XAxis | YAxis) -> None:
    """Label powers of ten, at most six; of few decades also digits between them, as plain numbers, as many as fit."""
    low, high = setting.get_view_interval()
    decades = math.log10(high / low)
    if decades > 3.0:
        setting.set_major_locator(LogLocator(numticks=6))
        setting.set_minor_formatter(NullFormatter())
        return
    few_fit = is_narrow() and isinstance(setting, XAxis)
    many, few = (0.4, 1.0) if few_fit else (0.9, 2.6)
    digits = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if decades < many else (1.0, 2.0, 5.0) if decades < few else (1.0,)
    setting.set_major_locator(LogLocator(subs=digits))
    setting.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    setting.set_minor_formatter(NullFormatter())


@dataclass(frozen=True)
class AxisUnit:
    """The unit of an axis.

    Attributes:
        worth: of one dimensionless unit, in it.
        symbol: such as ``ms``; ``reduced`` for reduced units.
    """

    worth: float
    symbol: str

    def label(self, kind: Any, name: str, words: str = "") -> str:
        """Text of an axis that shows a quantity: name (or words) and symbol as its type declares them, and unit.

        Such as ``time $t$ (ms)``.
        """
        return Label(words or name.replace("_", " "), declared(kind)[name][0].symbol, self.symbol).mathtext


@result
class FrameContent:
    """What frames hold."""

    time: Floats = declare("time of the frame", "time", symbol="t")
    velocity: Floats = declare("velocity of the bead", "velocity", symbol="v")
    force: Floats = declare("force at the time of the frame", "force", symbol="F")
    energy: Floats = declare("energy of the beads and of the forces on them", "energy", symbol="U")
    lag: Floats = declare("time of the frame after another instant", "time", symbol="\\Delta t")


def axis_unit(problem: Problem, quantity: str, largest: float) -> AxisUnit:
    """A unit in which an axis needs no powers of ten: s, ms, us, ns, likewise m/s; reduced units as they are.

    Args:
        problem: what is drawn.
        quantity: a key of `lammps_inputs.units.SI`, such as ``time`` or ``frequency``.
        largest: size of the largest number on the axis, dimensionless.
    """
    worth = float(problem.scale.measured(1.0, quantity))
    if problem.scale.si:
        unit = prefixed(SI[quantity], largest * worth)
        return AxisUnit(worth * unit.worth, unit.symbol)
    power = thousands(largest * worth)
    if -1 <= power <= 1:
        return AxisUnit(worth, "reduced")
    return AxisUnit(worth / 10.0 ** (3 * power), f"$10^{{{3 * power}}}$ reduced")


def prefixed(symbol: str, largest: float) -> AxisUnit:
    """An SI unit with the prefix of `lammps_inputs.units.prefix`, and what the plain one is worth."""
    power, letter = prefix(symbol, largest)
    return AxisUnit(10.0 ** (-3 * power), letter + symbol)


def letter(axes: Iterable[Axes]) -> None:
    """Letter the panels of a figure, (a), (b), ..., before their titles on the left; a single panel has no letter."""
    panels = list(axes)
    for axis, mark in zip(panels, string.ascii_lowercase if len(panels) > 1 else "", strict=False):
        axis.set_title(f"({mark}) {axis.get_title(loc='left')}".rstrip(), loc="left")


def grid(problem: Problem) -> tuple[int, int] | None:
    """Rows and columns of the lattice in which the chains stand; None where they are no lattice."""
    return next((link.grid for link in problem.system.couplings if link.grid is not None), None)


def shown_chains(problem: Problem, *, panels: bool = False) -> list[int]:
    """Chains that a figure shows, counted from 0, ascending: all, or the kicked ones and some far from those.

    Of more than `MAX_PANELS`, first the kicked ones (fastest first), then always the one farthest from all
    chosen so far, along the springs between chains.

    Args:
        problem: what is drawn.
        panels: whether each chain has a panel of its own; of a lattice there can be more then.
    """
    most_chains = MAX_PANELS_OF_LATTICE if panels and grid(problem) is not None else MAX_PANELS
    if problem.chains <= most_chains:
        return list(range(problem.chains))
    by_kick = sorted(physics.excitations(problem.system), key=lambda kick: -abs(kick[2]))
    chosen = list(dict.fromkeys(chain - 1 for chain, _, _ in by_kick))[:MAX_PANELS]
    distance = np.min([_distances(problem, chain) for chain in chosen], axis=0)
    while len(chosen) < MAX_PANELS:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, _distances(problem, chosen[-1]))
    return sorted(chosen)


def _distances(problem: Problem, chain: int) -> Floats:
    """[chain] how many springs away from a chain; as far as can be, and in numbers, if no spring leads there."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import dijkstra

    edges = np.array([pair for link in problem.system.couplings for pair in link.edges], dtype=np.int64).reshape(-1, 2)
    springs = coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(problem.chains, problem.chains)).tocsr()
    steps = dijkstra(springs, directed=False, unweighted=True, indices=chain)
    return np.where(np.isinf(steps), problem.chains + np.abs(np.arange(problem.chains) - chain), steps)


LETTERS_PER_INCH = 13
"""Letters of a title that fit into an inch."""


def _wrapped(line: str, width: float) -> str:
    """A line of a title in lines that fit into a width in inches; formulas, between dollar signs, are not broken."""
    unbroken = re.sub(r"\$[^$]*\$", lambda formula: formula[0].replace(" ", "\0"), line)
    return "\n".join(textwrap.wrap(unbroken, max(20, int(LETTERS_PER_INCH * width)))).replace("\0", " ")


def title(problem: Problem, *, each_chain: bool = False, panels: bool = False, until: float | None = None) -> str:
    """Name of a scene, its chains, coupling, gap, static load and V, for the top of a figure.

    Args:
        problem: what was run.
        each_chain: whether the figure shows each chain; of many it then says which ones.
        panels: whether each has a panel of its own.
        until: time of the last frame there is, in units of T; of a run that was cut short it is said.
    """
    system = problem.system
    numbers = [f"{problem.chains} chain{'s' * (problem.chains > 1)} of {problem.beads} beads"]
    if physics.coupled(system):
        numbers.append(_coupling(problem))
    if physics.gap(system):
        unit = axis_unit(problem, "length", physics.gap(system))
        numbers.append(f"gap {physics.gap(system) * unit.worth:.4g}{f' {unit.symbol}' if problem.scale.si else ''}")
    numbers += [
        *_load(problem),
        f"$V$ = {problem.scale.measured(1.0, 'velocity'):.4g}{problem.scale.after('velocity')}",
    ]
    cut = ""
    if until is not None and until < problem.duration - 0.5 * problem.every:
        cut = f"; cut short at {until / problem.duration:.0%} of its time"
    shown = ""
    chains = shown_chains(problem, panels=panels)
    if each_chain and len(chains) < problem.chains:
        shown = f"\n(chains {', '.join(str(chain + 1) for chain in chains)} are shown)"
    return ": ".join(filter(None, [problem.name, ", ".join(numbers)])) + cut + shown


def _load(problem: Problem) -> list[str]:
    """Static load of the contacts, in words; none without one."""
    if not physics.loaded(problem.system):
        return []
    forces = np.concatenate([np.ravel(laws.load(link.law)) for link in problem.system.along])
    ends = [problem.scale.written(float(force), "force", ".4g") for force in (np.min(forces), np.max(forces))]
    return [f"static load {ends[1]}" if ends[0] == ends[1] else f"static load {ends[0]} to {ends[1]}"]


def _coupling(problem: Problem) -> str:
    """Dimensionless stiffness of the springs between chains at rest, where they are, and which chains they tie."""
    still, pulled = (
        np.concatenate(
            [
                np.broadcast_to(laws.stiffness(link.law, strain), (len(link.edges), problem.beads))
                for link in problem.system.couplings
            ]
        )
        for strain in (0.0, 1.0)
    )
    rows = np.flatnonzero(np.any((still != 0.0) | (pulled != 0.0), axis=0)) + 1
    at_rest = still[:, rows - 1]
    least, largest = float(np.min(at_rest)), float(np.max(at_rest))
    symbol = "\\kappa" if problem.scale.time == 1.0 else "\\kappa = k T^2 / m"
    text = f"${symbol}$ = {largest:.4g}" if least == largest else f"${symbol}$ = {least:.3g} to {largest:.3g}"
    polynomial = all(isinstance(link.law, spring.Linear | spring.Duffing) for link in problem.system.couplings)
    text += (" and cubic" if polynomial else ", nonlinear") if np.any(pulled != still) else ""
    text += f" in rows {rows[0]} to {rows[-1]}" if len(rows) < problem.beads else ""
    return ", ".join([text, *(link.shape for link in problem.system.couplings if link.shape)])


def draw_chain(axis: Axes, place: int, chain: int, x: Floats | Integers, y: Floats) -> None:
    """Draw one line in the look of a chain (counted from 0) in a place, with marks where there are few numbers.

    Positions x [place] and values y [place] are in the units of the axes. A number between two that are NaN is a dot,
    for no line leads to it.
    """
    colour = CHAIN_COLOURS[place % len(CHAIN_COLOURS)]
    few = len(x) <= FEW_NUMBERS
    axis.plot(
        x,
        y,
        color=colour,
        linestyle=CHAIN_DASHES[place % len(CHAIN_DASHES)],
        marker="o" if few else None,
        markersize=4,
        label=f"chain {chain + 1}",
    )
    finite = np.pad(np.isfinite(y), 1)
    alone = finite[1:-1] & ~finite[:-2] & ~finite[2:]
    if np.any(alone) and not few:
        axis.plot(x[alone], y[alone], ".", color=colour, markersize=3)


@dataclass(frozen=True)
class Missing:
    """Beads at which there is no number.

    Attributes:
        beads: [bead] recorded ones without a number, ascending.
        period: beads of a cell of unlike beads, of which not all have one.
    """

    beads: Integers
    period: int


def broken(x: Integers | Floats, y: Floats, missing: Missing) -> tuple[Floats, Floats]:
    """A curve that is interrupted between beads that are more than a cell apart and have beads without number between.

    Args:
        x: [place] beads, ascending.
        y: [place, ...] values.
        missing: beads without a number.

    Returns:
        Both, with NaN inserted where the curve is interrupted.
    """
    before = np.searchsorted(missing.beads, x)
    place = np.flatnonzero((before[1:] > before[:-1]) & (np.diff(x) > missing.period)) + 1
    return np.insert(x.astype(np.float64), place, np.nan), np.insert(y, place, np.nan, axis=0)


def draw_chains(axis: Axes, chains: Sequence[int], x: Floats | Integers, y: Floats) -> None:
    """A line for each of the chains that a figure shows, from values [x, shown chain]."""
    for place, (chain, values) in enumerate(zip(chains, y.T, strict=True)):
        draw_chain(axis, place, chain, x, values)


def finish(
    figure: Figure, problem: Problem, axes: Iterable[Axes], *, until: float | None = None, note: str = ""
) -> None:
    """Add letters to the panels, a title that ends in a note, and a legend of the chains of the first panel.

    The legend is below the panels, where it hides no curve; a single chain has none. For ``until`` see `title`.
    """
    panels = list(axes)
    letter(panels)
    head(figure, title(problem, each_chain=True, until=until) + note)
    handles, labels = panels[0].get_legend_handles_labels()
    if len(handles) > 1:
        legend_below(figure, handles, labels)


def evenly_spaced(beads: Integers) -> bool:
    """Whether all beads [bead], ascending numbers, are equally far apart; a single one is not."""
    steps = np.diff(beads)
    return len(steps) > 0 and bool(np.all(steps == steps[0]))


def name_columns(axis: Axes, beads: Integers) -> None:
    """Write numbers of beads [bead] that are not evenly spaced under columns of one width, or under some of them."""
    named = np.unique(np.linspace(0, len(beads) - 1, min(len(beads), _MOST_LABELS)).round().astype(int))
    axis.set_xticks(named.tolist(), labels=[str(beads[place]) for place in named])
    axis.set_xlabel("recorded bead")


_PACKED = {"compress_level": 3}
"""Half the time of the usual 6, for files that are a tenth larger."""


@styled  # fonts are settings of saving, too
def picture(figure: Figure, suffix: str, dpi: float = STYLE["savefig.dpi"]) -> bytes:
    """What a file of this kind holds.

    Figures are laid out once, and PNG is drawn once; matplotlib on its own draws each file twice.

    Args:
        figure: what to draw.
        suffix: ``png``, ``pdf`` or ``svg``.
        dpi: dots per inch of what is not drawn with lines.
    """
    out = io.BytesIO()
    engine = figure.get_layout_engine()
    if engine is not None:
        figure.set_dpi(dpi)
        engine.execute(figure)
        figure.set_layout_engine("none")
    if suffix == "png":
        figure.set_dpi(dpi)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.print_png(out, pil_kwargs=_PACKED)
    else:
        figure.savefig(out, format=suffix, dpi=dpi)
    return out.getvalue()
