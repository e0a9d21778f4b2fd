"""Lines of a deck that say what a law on a link is to LAMMPS, sorted by the place where LAMMPS expects them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import engine_limits
from lammps_inputs.numbers import text

PLACES = "places"
"""Fix of LAMMPS that has noted where beads rest, where that is no formula of their numbers."""


@dataclass(frozen=True)
class LinksAcross:
    """Links between atoms of one row in two lines, for the LAMMPS commands of their law.

    Attributes:
        name: name in the deck, such as "coupling".
        edges: pairs of lines, the chains first, counted from 0, the lower number first.
        open_row: whether the lines stand in a row, each tied to the next.
        tie: whether they tie atoms beside the beads.
        alone: whether no other links couple chains, or tie such atoms.
        number: their place among the dashpots of the system, from 1; 0 of springs.
    """

    name: str
    edges: tuple[tuple[int, int], ...]
    open_row: bool = True
    tie: bool = False
    alone: bool = True
    number: int = 0


@dataclass(frozen=True, eq=False)
class WallLinks:
    """Links of the last bead of each chain, or the first, with a wall, for their LAMMPS commands.

    Attributes:
        name: name in the deck, such as "right_wall".
        law: law of the links, of parameters that are numbers or [chain, 1].
        side: 1 for a wall behind the last bead, -1 for one before the first.
        gap: displacement at which the bead touches the wall, in units of L.
        loss: dashpot law of the wall (`lammps_inputs.laws.dashpot`); None if it is undamped.
    """

    name: str
    law: Any
    side: float
    gap: float
    loss: Any = None


@dataclass(frozen=True, eq=False)
class BeadLayout:
    """Size and places of the beads in LAMMPS, and the laws beside a law, for its LAMMPS commands.

    The dynamics do not depend on any of it; `lammps_inputs.layout` makes one of a system. Lengths are in units of L.

    Attributes:
        chains: number of chains.
        beads: number of beads of each chain.
        rows: rows of beads that exist in LAMMPS.
        gap: clear distance between neighbouring beads, the largest if they differ; 0 where all touch.
        diameter: diameter of all beads.
        closer: how much closer than by a diameter and the gap neighbours are at rest, a number or [chain, contact]:
            their overlap under a static load, or smaller gaps.
        even: whether all neighbouring beads are equally far apart at rest.
        farthest: how much farther apart than at rest neighbours that act at a distance come, at most; 0 where none do.
        others: what atoms that are no beads are called; empty where there are none.
        alike: whether all beads are the same, and all contacts but for their static load.
        lightest, heaviest: smallest and largest mass of a bead.
        contact_loss: dashpot law of the contacts (`lammps_inputs.laws.dashpot`); None if they are undamped.
        walls: walls of the chains.
        closed: whether the chains are rings.
        velocity_at_full_steps: whether LAMMPS's step is of order 2 by masses that are larger
            (`lammps_inputs.laws.dashpot.Dashpot`).
    """

    chains: int
    beads: int
    rows: int
    gap: float
    diameter: float
    closer: float | NDArray[np.float64]
    even: bool
    farthest: float
    others: str
    alike: bool
    lightest: float
    heaviest: float
    contact_loss: Any
    walls: tuple[WallLinks, ...]
    closed: bool
    velocity_at_full_steps: bool

    def atom(self, chain: int, bead: int) -> int:
        """Number of a bead's atom in LAMMPS; all counted from 1."""
        return (chain - 1) * self.rows + bead

    @property
    def group(self) -> str:
        """LAMMPS's group of all beads."""
        return "beads" if self.others else "all"

    @property
    def diameter_of_others(self) -> float:
        """Diameter of atoms that are no beads, so small that those of two rows, as far apart as beads, never touch."""
        return self.diameter / 8.0

    @property
    def spacing(self) -> float:
        """Distance between the centres of neighbouring beads at rest; the largest, without load, if that differs."""
        return self.diameter + self.gap - (float(self.closer) if self.even else 0.0)

    def apart(self, edge: tuple[int, int]) -> float:
        """Lateral distance of the centres of two chains, the lower number first."""
        return 2.0 * (self.diameter + self.gap) * (edge[1] - edge[0])

    @property
    def places(self) -> NDArray[np.float64]:
        """Places of the beads at rest, [chain, bead], in units of L, to the last bit."""
        if self.even:
            row = np.arange(1, self.beads + 1) * self.spacing
            return np.broadcast_to(row, (self.chains, self.beads))
        places = np.full((self.chains, self.beads), self.spacing)
        places[:, 1:] -= self.closer
        return np.asarray(np.cumsum(places, axis=1))

    @property
    def place_formula(self) -> str:
        """Place at rest as a formula of LAMMPS in the number of the atom; where there is none, a fix has stored it."""
        return f"((id-1)%{self.rows}+1)*{text(self.spacing)}" if self.even else f"f_{PLACES}"


@dataclass(frozen=True)
class AtomTypes:
    """LAMMPS's types of atoms, by which it distinguishes contacts.

    Attributes:
        of: type of every bead, from 1, [chain, bead].
        strength: (type, type), the lower first, -> strength of the contact of two neighbours that are of these types.
        count: how many types there are.
    """

    of: NDArray[np.int64]
    strength: dict[tuple[int, int], float]
    count: int


@dataclass(frozen=True)
class DeckLines:
    """Lines and numbers that a law adds to a deck, also to its continuation; none by default.

    Attributes:
        variables: numbers at the top, which ``-var`` changes.
        interactions: interactions of atoms with each other, in a separate section.
        motion: fixes that act beside the integration, once the beads are read and at rest.
        moved: fixes that move beads by the time, for which the length of a step must be known.
        bonds: type of the bond that is each link across, [edge, row], counted from 1; 0 for none.
        style: style of these bonds.
        coefficients: coefficients of every type of bond, in the order of the types.
        types: types of the atoms, where contacts differ; else recorded beads are of type 2 and others of type 1.
        beside: a second pair style with its arguments, and the lines that give its coefficients.
        heavier: formula of the increase of the masses over half a time step.
        damped: whether the dashpots of contacts are in the lines of these.
        numbers: numbers of every bead, [chain, bead], in the data file, by their names in LAMMPS.

    Examples:
        >>> held = DeckLines(motion=("fix held all spring/self 0.1 x",))  # what `Law.ground` of a spring returns
        >>> held.variables, held.style
        ((), '')
    """

    variables: tuple[str, ...] = ()
    interactions: tuple[str, ...] = ()
    motion: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    bonds: NDArray[np.int64] | None = None
    style: str = ""
    coefficients: tuple[str, ...] = ()
    types: AtomTypes | None = None
    heavier: str | None = None
    beside: tuple[str, ...] = ()
    damped: bool = False
    numbers: dict[str, NDArray[np.float64]] | None = None


def types_by_contact(strength: NDArray[np.float64], *, closed: bool = False) -> AtomTypes:
    """Few types, of which any two neighbours' determine the strength of their contact: some sqrt(2 n) for n strengths.

    Only neighbours ever meet, so any strength may be that of any pair of types, once.

    Args:
        strength: dimensionless strengths, [chain, contact].
        closed: whether the last contact is that of the last bead with the first.
    """
    if closed:
        return _types_of_rings(strength)
    strengths: dict[tuple[int, int], float] = {}
    place: dict[tuple[int, float], int] = {}
    free: list[set[int]] = [{1}]  # of each type, those with which it has no strength yet
    rows: dict[bytes, NDArray[np.int64]] = {}
    for row in strength:
        if row.tobytes() in rows:
            continue
        types = [1]
        for value in row.tolist():
            last = types[-1]
            following = place.get((last, value))
            if following is None:
                if not free[last - 1]:
                    free.append(set(range(1, len(free) + 2)))
                    for others in free[:-1]:
                        others.add(len(free))
                following = max(free[last - 1], key=lambda kind: (len(free[kind - 1]), -kind))
                free[last - 1].discard(following)
                free[following - 1].discard(last)
                strengths[min(last, following), max(last, following)] = value
                place[last, value], place[following, value] = following, last
            types.append(following)
        rows[row.tobytes()] = np.array(types, dtype=np.int64)
    return AtomTypes(np.array([rows[row.tobytes()] for row in strength]), strengths, len(free))


def _types_of_rings(strength: NDArray[np.float64]) -> AtomTypes:
    """Types of rings: those of the chains without their last two beads, which have types of their own."""
    chains = types_by_contact(strength[:, :-3])
    strengths, count = dict(chains.strength), chains.count
    last: dict[bytes, tuple[int, int]] = {}
    for row, types in zip(strength, chains.of.tolist(), strict=True):
        if row.tobytes() not in last:
            before, behind = last[row.tobytes()] = count + 1, count + 2
            ends = (types[-1], before), (before, behind), (types[0], behind)
            strengths |= dict(zip(ends, row[-3:].tolist(), strict=True))
            count += 2
    of_last = np.array([last[row.tobytes()] for row in strength])
    return AtomTypes(np.concatenate([chains.of, of_last], axis=1), strengths, count)


def atoms_by_value(name: str, law: Iterable[Any], shape: tuple[int, int]) -> list[tuple[tuple[float, ...], str]]:
    """Distinct values of a law's parameters, and which atoms have them, as LAMMPS's ``group ... id`` takes it.

    Args:
        name: name of the links.
        law: parameters, numbers or [chain, bead].
        shape: chains and beads; atom = (chain - 1) * beads + bead.

    Returns:
        Values and ranges such as ``1:60 121:180``, without atoms whose values are all 0.

    Raises:
        EngineLimitError: more values than LAMMPS has groups for.
    """
    flat = np.stack([np.broadcast_to(parameter, shape).reshape(-1) for parameter in law], axis=-1)
    starts = np.flatnonzero(np.r_[True, np.any(flat[1:] != flat[:-1], axis=1)])
    ends = np.r_[starts[1:], len(flat)]
    ranges: dict[tuple[float, ...], list[str]] = {}
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        value = tuple(flat[start].tolist())
        if any(value):
            ranges.setdefault(value, []).append(f"{start + 1}:{end}")
    engine_limits.GROUPS.check(name, len(ranges))
    return [(value, " ".join(atoms)) for value, atoms in ranges.items()]


def atoms_by_row(
    name: str, values: Any, shape: tuple[int, int], of_chains: NDArray[np.bool_] | None = None
) -> list[tuple[NDArray[np.float64], str]] | None:
    """Distinct profiles along a chain, and the atoms of the chains that have them; None where each chain has one value.

    Args:
        name: name of the links.
        values: a number, or [chain, bead].
        shape: chains and beads; atom = (chain - 1) * beads + bead.
        of_chains: whether a chain is looked at, [chain]; all are by default.
    """
    chains, beads = shape
    numbers = np.arange(chains) if of_chains is None else np.flatnonzero(of_chains)
    rows = np.broadcast_to(values, shape)[numbers]
    if all(len(np.unique(row[row != 0.0])) <= 1 for row in rows):
        return None
    profiles, of_chain = np.unique(rows, axis=0, return_inverse=True)
    engine_limits.GROUPS.check(name, len(profiles))
    alike = (numbers[of_chain.reshape(-1) == number] for number in range(len(profiles)))
    atoms = (" ".join(f"{chain * beads + 1}:{(chain + 1) * beads}" for chain in group.tolist()) for group in alike)
    return list(zip(profiles, atoms, strict=True))


_STRAIGHT = 1e-12
"""Change of the slope, over the largest value, that is rounding."""


def row_formula(name: str, values: NDArray[np.float64], row: str) -> str:
    """A profile along a chain as a formula of LAMMPS in the number of the row, linear between its bends.

    Args:
        name: name of the links.
        values: profile, [bead], in the units of the deck.
        row: LAMMPS's name of the number of an atom's row, counted from 1.

    Raises:
        EngineLimitError: more bends than LAMMPS takes.
    """
    slope = np.diff(values)
    bend = np.diff(slope)
    bends = np.flatnonzero(np.abs(bend) > _STRAIGHT * np.max(np.abs(values)))
    engine_limits.BENDS.check(name, len(bends))
    terms = [text(values[0]), *([f"({text(slope[0])})*({row}-1)"] if slope[0] else [])]
    terms += [f"({text(bend[at])})*({row}>{at + 2})*({row}-{at + 2})" for at in bends.tolist()]
    return f"({'+'.join(terms)})"


def bonds_by_value(law: Iterable[Any], shape: tuple[int, int]) -> tuple[list[tuple[float, ...]], NDArray[np.int64]]:
    """Distinct values of a law's parameters, ascending, and which links have them, as types of LAMMPS's bonds.

    Args:
        law: parameters, numbers or [edge, row].
        shape: edges and rows.

    Returns:
        Values without those that are all 0, and the types [edge, row], from 1; 0 where all are 0.
    """
    if not any(np.ndim(parameter) for parameter in law):
        return [tuple(map(float, law))], np.broadcast_to(1, shape)
    table = np.stack([np.broadcast_to(parameter, shape).reshape(-1) for parameter in law], axis=-1)
    values, kind = np.unique(table, axis=0, return_inverse=True)
    nothing = int(not values[0].any())
    return [tuple(value) for value in values[nothing:].tolist()], (kind + 1 - nothing).reshape(shape)


def whole_contacts(link: LinksAcross) -> tuple[str, ...]:
    """Command that keeps contacts between beads tied by bonds, which LAMMPS leaves out by default; none if not needed.

    Bonds of an open row of chains never lead to a bead within reach; ties of other atoms to beads may.
    """
    return (
        ()
        if link.open_row and not link.tie
        else ("special_bonds lj/coul 1 1 1      # contacts between bonded beads are kept",)
    )
