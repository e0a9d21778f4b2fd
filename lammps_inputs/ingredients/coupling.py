"""Springs between the beads of one row in different chains: any graph of chains, all rows or some, linear or cubic."""

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Tag, field_validator

from lammps_inputs import laws, strict_yaml
from lammps_inputs.ingredients.base import (
    Cubic,
    Row,
    Rows,
    ScenePart,
    Setting,
    Stiffness,
    ends,
    in_rows,
    refuse_range,
    with_keys,
)
from lammps_inputs.ingredients.by_formula import ByFormula, formulas
from lammps_inputs.laws import Law
from lammps_inputs.laws.spring import Duffing, Linear
from lammps_inputs.links import Links
from lammps_inputs.system import System
from lammps_inputs.units import Label

Floats = NDArray[np.float64]
_Pair = tuple[Row, Row]
_Own = tuple[Row, Row, Stiffness]
Edge = Annotated[
    Annotated[_Pair, Tag("<pair>")] | Annotated[_Own, Tag("<own>")],
    Discriminator(lambda value: "<pair>" if isinstance(value, tuple) and len(value) <= 2 else "<own>"),
]

MOST = 1e12
"""Dimensionless stiffness; beyond it the rows are rigid."""


@with_keys(ends(Stiffness, "Stiffness up to the first bead of `rows`.", "Stiffness from the last bead of `rows` on."))
class Ramp(ScenePart):
    """Stiffness that changes evenly from bead ``rows[0]`` to ``rows[1]``, and stays as it is before and after."""

    rows: Rows
    """First and last bead of the ramp; the stiffness is constant before and after."""


class Graph(ScenePart):
    """Which chains are tied: one of the two."""

    lattice: Rows | None = None
    """Rows and columns of a lattice of chains, numbered row by row; each chain is coupled to its neighbours."""
    edges: tuple[Edge, ...] | None = None
    """Pairs of coupled chains; a third number is the stiffness of that pair."""

    _from_list = field_validator("edges", mode="before")(strict_yaml.as_tuple)


def _distinguished(model: type[ScenePart]) -> Discriminator:
    """Pairs of keys and values are the model, all else is tried as the plain value."""
    return Discriminator(lambda value: "<keys>" if isinstance(value, dict | model) else "<plain>")


_Stiffness = Annotated[Annotated[Stiffness, Tag("<plain>")] | Annotated[Ramp, Tag("<keys>")], _distinguished(Ramp)]
_Name = Literal["open", "ring"]
_Topology = Annotated[Annotated[_Name, Tag("<plain>")] | Annotated[Graph, Tag("<keys>")], _distinguished(Graph)]


class Coupling(ByFormula):
    """Springs between chains: a force ``stiffness s + cubic s**3``, or any, for beads of a row that are s apart."""

    example: ClassVar[str] = "{stiffness: 0.1}"
    sources = ("starosvetsky2013",)

    model: Literal["linear"] = "linear"
    """Kind of spring."""
    stiffness: Annotated[_Stiffness | None, Label("coupling stiffness", "k")] = None
    """Linear stiffness k: a number, or a ramp `{from, to, rows}`. Required unless every edge has its own."""
    rows: Rows | None = None
    """First and last row with springs; all rows if omitted."""
    topology: _Topology | None = None
    """Which chains are coupled, by the table below; `open` if omitted."""
    cubic: Annotated[Cubic | None, Label("cubic coupling stiffness", "k_3")] = None
    """Cubic stiffness k_3; none if omitted."""
    force: str | None = None
    """Force as a formula of s, odd, with its parameters as keys beside it; in place of `stiffness` and `cubic`."""

    def refuse(self, setting: Setting) -> None:
        """Refuse what does not fit the chains, springs that are practically rigid, and rows that differ in a window."""
        by_edge = bool(self._named) and all(len(edge) == 3 for edge in self._named)
        if self.formula is not None:
            self._refuse_formula(self.formula)
        elif self.stiffness is None and self.cubic is None and not by_edge:
            raise ValueError("coupling.stiffness: is missing")
        if self.stiffness is not None and by_edge:
            raise ValueError("coupling.stiffness: every edge has a stiffness of its own; leave this one out")
        ramp = self.stiffness if isinstance(self.stiffness, Ramp) else None
        for key, rows, least in (("rows", self.rows, 0), ("stiffness.rows", None if ramp is None else ramp.rows, 1)):
            refuse_range(f"coupling.{key}", rows, setting.beads, least=least)
        self._refuse_edges(setting.chains)
        edges = self._edges(setting.chains)
        for key, values in (("stiffness", self._stiffness(edges, setting)), ("cubic", self._cubic(edges, setting))):
            if (largest := float(np.max(values, initial=0.0))) > MOST:
                raise ValueError(
                    f"coupling.{key}: {largest:.3g} in dimensionless units, so stiff that the rows are rigid; "
                    "at most 1e12"
                )
        if setting.part("window") is not None and (self.rows is not None or ramp is not None):
            raise ValueError(
                f"coupling.{'stiffness' if self.rows is None else 'rows'}: a window takes rows from its tail to its "
                "head with the springs they have, so all must have the same; leave the window out"
            )

    def _refuse_formula(self, force: Any) -> None:
        self.refuse_beside("coupling", "stiffness", "cubic")
        if any(len(edge) == 3 for edge in self._named):
            raise ValueError(
                "coupling.topology.edges: a stiffness is that of linear springs; leave the third number out"
            )
        formulas().refuse_unrest("coupling", force)
        formulas().refuse_even("coupling", force)

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse formulas without a value."""
        for link in system.couplings if self.formula is not None else ():
            if link.law.source is not None:
                formulas().refuse_reach("coupling", link.law, system, setting.scale.length)

    def _refuse_edges(self, chains: int) -> None:
        topology = self.topology
        if isinstance(topology, Graph) and (topology.lattice is None) == (topology.edges is None):
            raise ValueError("coupling.topology: give either lattice or edges")
        if self._grid is not None and self._grid[0] * self._grid[1] != chains:
            rows, columns = self._grid
            raise ValueError(f"coupling.topology.lattice: {rows} x {columns} places for {chains} chains")
        pairs = set()
        for number, (first, second, *_) in enumerate(self._named, 1):
            key = f"coupling.topology.edges[{number}]"
            if max(first, second) > chains:
                raise ValueError(f"{key}: {max(first, second)} is outside the array (chains 1 to {chains})")
            if first == second:
                raise ValueError(f"{key}: ties chain {first} to itself; name two chains")
            pair = (min(first, second), max(first, second))
            if pair in pairs:
                raise ValueError(f"{key}: chains {pair[0]} and {pair[1]} are tied twice; add the stiffnesses up")
            pairs.add(pair)

    def links(self, setting: Setting) -> tuple[Links, ...]:
        """Links across the chains; none where no two chains are tied by any spring."""
        edges = self._edges(setting.chains)
        if self.formula is not None and formulas().multiple_of_strain(self.formula) is None:
            return self._by_formula(self.formula, edges, setting)
        spring, cubic = self._stiffness(edges, setting), self._cubic(edges, setting)
        holds = np.zeros(len(edges), dtype=bool)
        for values in (spring, cubic):
            holds |= np.any(values, axis=1) if isinstance(values, np.ndarray) else values != 0.0
        if not holds.any():
            return ()
        spring, cubic = (values[holds] if isinstance(values, np.ndarray) else values for values in (spring, cubic))
        law: Law = Duffing(spring, cubic) if np.any(cubic) else Linear(spring)
        pairs = tuple((lower, higher) for (lower, higher, _), tied in zip(edges, holds, strict=True) if tied)
        return (Links.across("coupling", law, pairs, self._grid),)

    def _by_formula(self, force: Any, edges: list[Any], setting: Setting) -> tuple[Links, ...]:
        if not edges:
            return ()
        strength = 1.0 if self.rows is None else in_rows(1.0, self.rows, (len(edges), setting.beads))
        law = laws.dimensionless(force.law(formulas().AcrossChains, strength=strength), setting.scale)
        return (Links.across("coupling", law, tuple(edge[:2] for edge in edges), self._grid),)

    @property
    def _grid(self) -> tuple[int, int] | None:
        return self.topology.lattice if isinstance(self.topology, Graph) else None

    @property
    def _named(self) -> tuple[_Pair | _Own, ...]:
        """Edges that the scene names one by one."""
        return (self.topology.edges or ()) if isinstance(self.topology, Graph) else ()

    def _edges(self, chains: int) -> list[tuple[int, int, float | None]]:
        """Pairs of tied chains, counted from 0, the lower number first, in order; and a stiffness of their own."""
        if isinstance(self.topology, Graph) and self._grid is None:
            named = [(edge[0] - 1, edge[1] - 1, edge[2] if len(edge) == 3 else None) for edge in self._named]
            return sorted((min(first, second), max(first, second), stiffness) for first, second, stiffness in named)
        if self._grid is not None:
            if self._grid[0] * self._grid[1] != chains:  # refused
                return []
            places = np.arange(chains).reshape(self._grid)
            neighbours = [(places[:, :-1], places[:, 1:]), (places[:-1], places[1:])]
            pairs = [pair for ends in neighbours for pair in zip(*(end.ravel().tolist() for end in ends), strict=True)]
        else:
            pairs = [(chain, chain + 1) for chain in range(chains - 1)]
            pairs += [(0, chains - 1)] if self.topology == "ring" and chains > 2 else []
        return [(lower, higher, None) for lower, higher in sorted(pairs)]

    def _stiffness(self, edges: list[tuple[int, int, float | None]], setting: Setting) -> float | Floats:
        """Dimensionless linear stiffness: a number, or [edge, row] where it differs."""
        shared: Any = 0.0 if self.stiffness is None else self.stiffness
        if self.formula is not None:
            shared = formulas().multiple_of_strain(self.formula) or 0.0
        if isinstance(shared, Ramp):
            values = [getattr(shared, key) for key in ("from", "to")]
            shared = np.interp(np.arange(1, setting.beads + 1), shared.rows, values)
        by_edge = [shared if stiffness is None else stiffness for _, _, stiffness in edges]
        return self._table(by_edge if any(edge[2] is not None for edge in edges) else [shared], edges, setting, 1.0)

    def _cubic(self, edges: list[tuple[int, int, float | None]], setting: Setting) -> float | Floats:
        """Dimensionless cubic stiffness: a number, or [edge, row] where it differs."""
        return self._table([self.cubic or 0.0], edges, setting, 1.0 / setting.scale.length**2)

    def _table(self, values: list[Any], edges: list[Any], setting: Setting, unit: float) -> float | Floats:
        """Dimensionless values of all edges, or of each, a number or [row], in the rows that have springs."""
        table = np.reshape(np.stack(np.broadcast_arrays(*values)) / (unit * setting.scale.stiffness), (len(values), -1))
        if self.rows in (None, (1, setting.beads)) and np.ptp(table) == 0.0:
            return float(table[0, 0])
        return in_rows(table, self.rows, (len(edges), setting.beads))
