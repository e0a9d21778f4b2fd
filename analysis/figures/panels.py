"""Panels of figures as data: curves and images with labels and units, without a drawing library.

A figure of a run is a `Sheet` of `Panel`s, which pure functions of arrays make. `drawing.draw` draws it with
matplotlib, the page of a run draws its panels with Bokeh, and `granchain export` writes them as tables. Plug-ins take
this module for figures of their own measures, and for units and titles of all figures.

Examples:
    >>> problem = granchain.load("two-chains-steel").problem()
    >>> unit = panels.axis_unit(problem, "velocity", 0.5)
    >>> bead, speed = np.array([1, 2, 3]), np.array([0.5, 0.4, 0.4])
    >>> curve = panels.Curve("chain 1", bead, speed * unit.worth, place=0)
    >>> panel = panels.Panel(panels.BEAD, unit.axis(panels.FrameContent, "velocity"), (curve,))
    >>> panel.y.label.mathtext
    'velocity $v$ (mm/s)'
    >>> drawing.draw(panels.Sheet(panels.title(problem), ((panel,),), 3.0)).savefig(tmp / "speed.png", dpi=30)
"""

import string
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from analysis.quantity import declare, declared, result
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem, laws, physics
from lammps_inputs.units import REDUCED, Label

MAX_PANELS = 9
"""Chains that a figure shows at most, see `shown_chains`."""

MAX_PANELS_OF_LATTICE = 25
"""Chains of a lattice that a figure shows at most, each in a panel that stands as the chain does."""


# --- units ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class AxisUnit:
    """The unit of an axis.

    Attributes:
        worth: of one dimensionless unit, in it.
        symbol: such as ``ms``; ``reduced`` for reduced units.
    """

    worth: float
    symbol: str

    @property
    def behind(self) -> str:
        """What stands behind a number: ``" ms"``, or nothing behind one in reduced units."""
        return "" if self.symbol == REDUCED else f" {self.symbol}"

    def axis(self, kind: Any, name: str, words: str = "", **options: Any) -> "Axis":
        """Axis of a quantity: name (or words) and symbol as its type declares them, and unit, such as ``time t (ms)``.

        Args:
            kind: type whose field declares the quantity.
            name: of the field.
            words: in place of the name.
            options: other attributes of the axis.
        """
        label = Label(words or name.replace("_", " "), declared(kind)[name][0].symbol, self.symbol)
        return Axis(label, self.worth, **options)


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
    label, factor = Label("", unit=problem.scale.symbol(quantity)).prefixed(largest * worth)
    return AxisUnit(worth * factor, label.unit)


# --- panels -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Axis:
    """What an axis of a panel shows.

    Attributes:
        label: words, symbol and unit.
        worth: of one dimensionless unit, in that of the axis.
        ends: lowest and highest number; None for what is drawn.
        log: whether it is logarithmic.
        beads: whether it counts beads, which are whole and not below 0.
        ticks: numbers that are named, and their names; of an empty one as many as fit.
    """

    label: Label
    worth: float = 1.0
    ends: tuple[float | None, float | None] = (None, None)
    log: bool = False
    beads: bool = False
    ticks: Mapping[float, str] = field(default_factory=dict)


BEAD = Axis(Label("bead"), beads=True)


@dataclass(frozen=True)
class Curve:
    """A line of a panel; numbers are in the units of its axes.

    Attributes:
        name: in legends and tables.
        x, y: [point]; NaN interrupts the line.
        place: of the chain among those shown, which has a colour and dashes of its own; None for what is no chain's.
        look: of the line in figures, as matplotlib calls it.
        spread: [point] half of the height of a band around the line; None for no band.
    """

    name: str
    x: Floats | Integers
    y: Floats
    place: int | None = None
    look: Mapping[str, Any] = field(default_factory=dict)
    spread: Floats | None = None


@dataclass(frozen=True)
class Marks:
    """Straight lines across a panel, which are not among its numbers.

    Attributes:
        places: [line] on the axis that they cross, in its unit.
        name: in the legend; empty for none.
        look: as matplotlib calls it.
        level: whether they are horizontal.
    """

    places: Sequence[float] | Floats
    name: str = ""
    look: Mapping[str, Any] = field(default_factory=dict)
    level: bool = False


@dataclass(frozen=True)
class Image:
    """Values over both axes of a panel, as colours.

    Attributes:
        values: [row, column] from the lower left; NaN where there is none.
        x, y: ends of the axes, half a pixel beyond the middles of the first and last pixels, in the units of the axes.
        label: of the values.
        colours: values at the ends of the colours.
        signed: whether colours diverge from 0 along the signed square root.
        missing: name of what has no value.
        columns: numbers of the beads of the columns, where they are not evenly spaced and stand side by side.
    """

    values: Floats
    x: tuple[float, float]
    y: tuple[float, float]
    label: Label
    colours: tuple[float, float]
    signed: bool = False
    missing: str = ""
    columns: Integers | None = None

    @property
    def heading(self) -> str:
        """Text of the bar of colours."""
        return f"{self.label.mathtext}; colour: signed square root" if self.signed else self.label.mathtext


@dataclass(frozen=True)
class Panel:
    """What one panel of a figure shows.

    Attributes:
        x, y: its axes.
        curves: lines.
        title: on the left above it.
        remark: on the right above it, in small letters.
        marks: straight lines across it.
        layers: curves that lie on top of each other as areas, each with values of its own.
        image: values as colours.
    """

    x: Axis
    y: Axis
    curves: tuple[Curve, ...] = ()
    title: str = ""
    remark: str = ""
    marks: tuple[Marks, ...] = ()
    layers: tuple[Curve, ...] = ()
    image: Image | None = None


@dataclass(frozen=True)
class Sheet:
    """Panels of one figure.

    Attributes:
        title: above all.
        rows: panels from the upper left; None where there is none.
        height, width: in inches, without a width that is asked for.
        same_y: panels whose vertical axes have the same ends, as matplotlib calls them.
        heights: of rows relative to each other; those that are less high than the first belong to the one above.
        widths: likewise of columns of which all but the first are close-ups; a narrow figure has the first of these.
    """

    title: str
    rows: Sequence[Sequence[Panel | None]]
    height: float
    width: float = 7.0
    same_y: Literal["none", "row", "all"] = "none"
    heights: tuple[float, ...] = ()
    widths: tuple[float, ...] = ()

    @property
    def panels(self) -> list[Panel]:
        """Panels, row after row."""
        return [panel for row in self.rows for panel in row if panel is not None]

    @property
    def titles(self) -> list[str]:
        """Title of each panel after a letter, (a), (b), ...; that of a single panel has none."""
        heights = self.heights or (1.0,) * len(self.rows)
        rows = zip(self.rows, heights, strict=True)
        lettered = [height == heights[0] for row, height in rows for panel in row if panel is not None]
        letters = iter(string.ascii_lowercase if sum(lettered) > 1 else "")
        marks = [f"({letter}) " if has and (letter := next(letters, "")) else "" for has in lettered]
        return [f"{mark}{panel.title}".rstrip() for mark, panel in zip(marks, self.panels, strict=True)]


def curves_of(chains: Sequence[int], x: Floats | Integers, y: Floats) -> tuple[Curve, ...]:
    """A curve for each chain that is shown.

    Args:
        chains: counted from 0.
        x: [point] in the unit of its axis.
        y: [point, chain] of these chains, in the unit of its axis.

    Returns:
        The curves, in the order of the chains.
    """
    return tuple(
        Curve(f"chain {chain + 1}", x, values, place)
        for place, (chain, values) in enumerate(zip(chains, y.T, strict=True))
    )


def alone(y: Floats) -> Flags:
    """Points of a line that have no neighbour with a number, so that no line leads to them.

    Args:
        y: [point] in any unit; NaN for no number.

    Returns:
        The mask, [point].
    """
    finite = np.pad(np.isfinite(y), 1)
    return np.asarray(finite[1:-1] & ~finite[:-2] & ~finite[2:])


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
        x: [place] numbers of beads, dimensionless, ascending.
        y: [place, ...] values in the unit of their axis.
        missing: beads without a number.

    Returns:
        Both, [place] and [place, ...] in their units, with NaN inserted where the curve is interrupted.
    """
    before = np.searchsorted(missing.beads, x)
    place = np.flatnonzero((before[1:] > before[:-1]) & (np.diff(x) > missing.period)) + 1
    return np.insert(x.astype(np.float64), place, np.nan), np.insert(y, place, np.nan, axis=0)


def evenly_spaced(beads: Integers) -> bool:
    """Whether all beads [bead], ascending numbers, are equally far apart; a single one is not."""
    steps = np.diff(beads)
    return len(steps) > 0 and bool(np.all(steps == steps[0]))


# --- chains and titles ------------------------------------------------------------------------------------------------


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
        least = float(np.min(system.along[0].gap)) * unit.worth
        range_of_gaps = "gap" if physics.one_gap(system) else f"gaps {least:.4g} to"
        numbers.append(
            f"{range_of_gaps} {physics.gap(system) * unit.worth:.4g}{f' {unit.symbol}' if problem.scale.si else ''}"
        )
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
    forces = np.concatenate([np.ravel(link.law.load) for link in problem.system.along])
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
    polynomial = all(link.law.linear or "cubic" in link.law.names for link in problem.system.couplings)
    text += (" and cubic" if polynomial else ", nonlinear") if np.any(pulled != still) else ""
    text += f" in rows {rows[0]} to {rows[-1]}" if len(rows) < problem.beads else ""
    return ", ".join([text, *(link.shape for link in problem.system.couplings if link.shape)])
