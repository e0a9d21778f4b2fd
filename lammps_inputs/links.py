"""Links between beads, along a chain and across chains, and with places that never move, each with a law of force.

The strain of a link is how far its first end has come towards, and into, its second, along the chain; the law's force
drives the first back and the second forward. All of the equation of motion is here: what else is computed, such as
energy or acceleration, is a sum over links. A chain has a place at either end, where a wall may be, and each bead has
its place at rest, the ground: such places are of infinite mass, so that only the other end moves.

Displacements (in L), velocities (in V) and accelerations (in V / T) of beads are [..., chain, bead]. Forces (in
m V / T) and energies (in m V**2) of links are [..., chain, contact], [..., edge, row], [..., chain, bead] or, at a
wall and where a ring closes, [..., chain, 1]: in short [..., link]. Functions of arrays that hold only some rows take
``first``, the bead with which the last axis begins, by which they choose the parameters of a law that differs from link
to link.
"""

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.laws import Law, dashpot

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

Kind = Literal["along", "closing", "across", "ground", "wall"]

DENSE = 300
"""Chains up to which eigenvalues of a graph are computed."""


class Beads(NamedTuple):
    """Beads at one end of links.

    Attributes:
        rows: which of a line.
        lines: line of each link, counted from 0, chains first; None of links in every chain.
    """

    rows: slice
    lines: tuple[int, ...] | None = None


EACH = Beads(slice(None))
FIRST, LAST = Beads(slice(0, 1)), Beads(slice(-1, None))


class LinksOfBeads(NamedTuple):
    """Links of chosen beads, one of each, [bead].

    Attributes:
        exists: whether there is one.
        sign: 1 where these beads are at the first ends, -1 at the second.
        line: chain or edge of the link, from 0.
        place: position of the link in it, from 0.
        other: line and position of the bead at the other end, of itself where there is no link; None of a place.
    """

    exists: Flags
    sign: float
    line: Integers
    place: Integers
    other: tuple[Integers, Integers] | None

    def apart(self, at_beads: Floats, values: Floats, frame: Integers) -> Floats:
        """Differences of the first ends from the second, [..., bead].

        Args:
            at_beads: displacements or velocities of the beads, [..., bead].
            values: those of all, [frame, line, bead].
            frame: [..., bead] positions of frames.
        """
        return self.sign * (at_beads if self.other is None else at_beads - values[frame, *self.other])


@dataclass(frozen=True, eq=False)
class Links:
    """Links with one law, each from a first to a second end.

    Attributes:
        name: name for users, such as "coupling".
        law: law of every link.
        first, second: beads at the ends; None of places that never move.
        gap: clear distance of the ends at rest: a number, or [chain, contact] along the chains.
        grid: rows and columns in which chains stand that are tied, numbered row by row, where they are a lattice.
        curved: whether a place has as curved a surface as the bead that meets it, as another bead has; else it is flat.

    Examples:
        >>> [contacts] = granchain.load("two-chains").system.along
        >>> contacts.strain(np.array([[0.7, 0.5, 0.0]]))  # of displacements, [chain, bead], in units of L
        array([[0.2, 0.5]])
    """

    name: str
    law: Law
    first: Beads | None
    second: Beads | None
    gap: float | Floats = 0.0
    grid: tuple[int, int] | None = None
    curved: bool = False

    def __post_init__(self) -> None:
        """Refuse what no engine computes.

        Raises:
            ValueError: a law that depends on time, of links that are not to the ground.
        """
        if self.law.varies and self.kind != "ground":
            raise ValueError(f"{self.name}: a law that depends on time is that of links to the ground")

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number of every array."""
        if not isinstance(other, Links) or type(self.law) is not type(other.law):
            return False
        named = [field.name for field in fields(self) if field.name not in ("law", "gap")]
        return all(getattr(self, name) == getattr(other, name) for name in named) and all(
            map(np.array_equal, (self.gap, *self.law), (other.gap, *other.law))
        )

    def __hash__(self) -> int:
        return hash((self.name, self.kind, type(self.law)))

    # --- kinds --------------------------------------------------------------------------------------------------------

    @classmethod
    def along(cls, name: str, law: Law, gap: float | Floats = 0.0) -> "Links":
        """Links of each bead with the next of its chain, [..., chain, contact]; contact i is that of beads i and i + 1.

        Args:
            name: name for users.
            law: law of every link.
            gap: clear distance at rest, a number or [chain, contact].
        """
        return cls(name, law, Beads(slice(None, -1)), Beads(slice(1, None)), gap)

    @classmethod
    def closing(cls, name: str, law: Law, gap: float | Floats = 0.0) -> "Links":
        """Links of the last bead of each chain with the first, which close it to a ring, [..., chain, 1].

        Displacements count from places at rest, so that the length of the ring is in none of the strains.

        Args:
            name: name for users.
            law: law of every link.
            gap: clear distance at rest, a number or [chain, 1].
        """
        return cls(name, law, LAST, FIRST, gap)

    @classmethod
    def across(
        cls, name: str, law: Law, edges: tuple[tuple[int, int], ...], grid: tuple[int, int] | None = None
    ) -> "Links":
        """Links of the atoms of a row in two lines, [..., edge, row].

        Args:
            name: name for users.
            law: law of every link, whose force must be odd in the strain.
            edges: pairs of chains, or of further lines of atoms after them, counted from 0, the lower number first.
            grid: rows and columns in which the chains stand, numbered row by row, where they are a lattice.
        """
        lower, higher = (tuple(edge[end] for edge in edges) for end in (0, 1))
        return cls(name, law, Beads(slice(None), lower), Beads(slice(None), higher), grid=grid)

    @classmethod
    def ground(cls, name: str, law: Law) -> "Links":
        """Links of each bead with its place at rest, [..., chain, bead]; their law may depend on time.

        Args:
            name: name for users.
            law: law of every link.
        """
        return cls(name, law, EACH, None)

    @classmethod
    def wall(cls, name: str, law: Law, side: float, gap: float = 0.0, *, curved: bool = False) -> "Links":
        """Links of the last bead of each chain with the place behind it, or of the first with that before it.

        A wall pushes, or pulls where contacts do, and lets no bead oscillate. Arrays are [..., chain, 1].

        Args:
            name: name for users.
            law: law of contacts or of their dashpots.
            side: 1 behind the last beads, -1 before the first.
            gap: clear distance at rest.
            curved: whether its surface is as curved as the bead that meets it, as that of another bead; else it is
                flat.
        """
        first, second = (LAST, None) if side > 0.0 else (None, FIRST)
        return cls(name, law, first, second, gap, curved=curved)

    # --- ends ---------------------------------------------------------------------------------------------------------

    @cached_property
    def kind(self) -> Kind:
        """Which beads are linked: neighbours of a chain, its last and first bead, beads of a row, or beads and their
        places, all or the last.
        """
        if (self.first, self.second) == (LAST, FIRST):
            return "closing"
        if self.first is not None and self.second is not None:
            return "along" if self.first.lines is None else "across"
        return "ground" if EACH in (self.first, self.second) else "wall"

    @property
    def between(self) -> slice:
        """Places of these links, along the chain, among those before, between and behind its beads, [bead + 1].

        Raises:
            ValueError: they are not along the chain.
        """
        if self.kind == "along":
            return slice(1, -1)
        if not self.touching:
            raise ValueError(f"{self.name}: are not along the chain")
        return slice(0, 1) if self.first is None else slice(-1, None)

    @property
    def touching(self) -> bool:
        """Whether these links are along the chain, between its beads and with the places at its ends."""
        return self.kind in ("along", "closing", "wall")

    @property
    def side(self) -> float:
        """1 where the strain of a bead with its place grows towards higher bead numbers, -1 where towards lower."""
        return 1.0 if self.second is None else -1.0

    @property
    def ends(self) -> tuple[tuple[Beads, float], ...]:
        """Ends that are beads, each with the sign of its displacement in the strain; the second before the first."""
        signed = ((self.second, -1.0), (self.first, 1.0))
        return tuple((beads, sign) for beads, sign in signed if beads is not None)

    def of_beads(self, chain: Integers, bead: Integers, shape: tuple[int, ...]) -> Iterator[LinksOfBeads]:
        """Links of chosen beads, as many times as any bead has one.

        Args:
            chain, bead: [bead] lines and positions of the beads, from 0.
            shape: numbers of lines and of beads of each in arrays of all.
        """
        lines, beads = shape
        if self.kind == "across":
            for side in (-1, 1):
                for edge, partner in partners(self.edges, lines, side):
                    yield LinksOfBeads(edge[chain] >= 0, float(side), edge[chain], bead, (partner[chain], bead))
            return
        for _, sign in self.ends:
            if self.kind == "along":
                other = bead + int(sign)
                exists = (other >= 0) & (other < beads)
                place = np.clip(np.minimum(bead, other), 0, beads - 2)
                yield LinksOfBeads(exists, sign, chain, place, (chain, np.where(exists, other, bead)))
            elif self.touching:
                here, there = (beads - 1, 0) if sign > 0.0 else (0, beads - 1)
                exists = bead == here
                last = None if len(self.ends) == 1 else (chain, np.where(exists, there, bead))
                yield LinksOfBeads(exists, sign, chain, np.zeros_like(bead), last)
            else:
                yield LinksOfBeads(np.ones(bead.shape, dtype=bool), sign, chain, bead, None)

    @property
    def differ(self) -> bool:
        """Whether law or gap differ from link to link."""
        return np.ndim(self.gap) > 0 or laws.differs(self.law)

    def gap_at(self, *index: Any) -> Any:
        """Gaps of chosen links, an index of [chain, contact] from 0; the number where all have the same."""
        return self.gap[index] if isinstance(self.gap, np.ndarray) else self.gap

    def lines_among(self, chains: int) -> slice:
        """Lines of atoms, the chains first, among which these links may be: all of links across, else the chains."""
        return slice(None) if self.kind == "across" else slice(chains)

    def on(self, rows: slice | Integers) -> Self:
        """Links among chosen rows, [row], counted from 0; each is taken to be next to the one before."""
        if self.kind in ("closing", "wall") or not self.differ:
            return self
        if self.kind == "along":
            rows = slice(rows.start, rows.stop - 1) if isinstance(rows, slice) else rows[:-1]
        return replace(self, law=laws.at(self.law, Ellipsis, rows), gap=self.gap_at(Ellipsis, rows))

    def at(self, time: Any) -> Self:
        """Links at a time, a number or [...]; their law then does not depend on time."""
        if not self.law.varies:
            return self
        return replace(self, law=self.law.now(np.asarray(time)[..., np.newaxis, np.newaxis]))

    # --- strain and force ---------------------------------------------------------------------------------------------

    def strain(self, displacement: Floats) -> Floats:
        """Strain of each link, [..., link], in units of L, at displacements [..., chain, bead]; overlap above rest."""
        return self.rate(displacement) - self.gap

    def rate(self, velocity: Floats) -> Floats:
        """Rate of the strain of each link, [..., link], in units of V; the strain is linear in the displacements."""
        first, second = (None if index is None else velocity[index] for index in self._indices)
        if first is None:
            assert second is not None
            return np.asarray(-second)
        return np.asarray(first if second is None else first - second)

    def overlap(self, displacement: Floats, first: int = 1) -> Floats:
        """Overlap at each link, [..., link], that at rest included."""
        among = self._among(displacement, first)
        return np.asarray(among.strain(displacement) + among.law.rest)

    def energy(self, displacement: Floats, first: int = 1) -> Floats:
        """Energy stored in each link, [..., link], at displacements [..., chain, bead]."""
        among = self._among(displacement, first)
        return np.asarray(laws.energy(among.law, among.strain(displacement)))

    def force(self, displacement: Floats, first: int = 1) -> Floats:
        """Force of each link, [..., link], at displacements [..., chain, bead]."""
        among = self._among(displacement, first)
        return np.asarray(laws.force(among.law, among.strain(displacement)))

    def force_rate(self, displacement: Floats, velocity: Floats) -> Floats:
        """Rate of change of the force of each link, [..., link], in units of m V / T**2."""
        among = self._among(displacement, 1)
        law, s = among.law, among.strain(displacement)
        return np.asarray(laws.stiffness(law, s) * self.rate(velocity) + law.change(s, *law))

    def damping(self, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
        """Force of each dashpot, [..., link], which is 0 at rest."""
        among = self._among(displacement, first)
        return np.asarray(dashpot.damping(among.law, among.strain(displacement), self.rate(velocity)))

    def damping_rate(self, displacement: Floats, velocity: Floats, acceleration: Floats, first: int = 1) -> Floats:
        """Rate of change of the force of each dashpot, [..., link], in units of m V / T**2, but for jumps."""
        among = self._among(displacement, first)
        return np.asarray(
            dashpot.change(among.law, among.strain(displacement), self.rate(velocity), self.rate(acceleration))
        )

    def given(self, displacement: Floats, first: int = 1) -> Floats:
        """Impulse of each dashpot, [..., link], in units of m V, since its strain was 0, as if no tension were cut."""
        among = self._among(displacement, first)
        return np.asarray(among.law.impulse(among.strain(displacement), *among.law))

    # --- sums over links ----------------------------------------------------------------------------------------------

    def drive(self, total: Floats, force: Floats) -> None:
        """Add to ``total``, [..., chain, bead]: links push beads at the second ends forward, at the first ends back."""
        for beads, sign in self.ends:
            self._add(total, beads, force, -sign)

    def shared(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain, bead], energies of the links, of which two beads have half each."""
        for beads, _ in self.ends:
            self._add(total, beads, energy, 1.0 / len(self.ends))

    def add_chain_energy(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain], energies of the links; two chains that are tied have half each."""
        of_line = np.sum(energy, axis=-1)
        for edge, ends in enumerate(self.edges):
            for line in ends:
                total[..., line] += 0.5 * of_line[..., edge]
        if not self.edges:
            total += of_line

    def _add(self, total: Floats, beads: Beads, values: Floats, factor: float) -> None:
        if beads.lines is None or self.open_row:
            total[self._index(beads)] += factor * values
            return
        for edge, line in enumerate(beads.lines):  # edges may share a line
            total[..., line, :] += factor * values[..., edge, :]

    def _among(self, displacement: Floats, first: int) -> Self:
        """Links among the beads of an array."""
        return self.on(slice(first - 1, first - 1 + displacement.shape[-1]))

    @cached_property
    def _indices(self) -> tuple[Any, Any]:
        """Indices of the ends in arrays [..., line, bead]; None of places."""
        first, second = (None if beads is None else self._index(beads) for beads in (self.first, self.second))
        return first, second

    def _index(self, beads: Beads) -> tuple[Any, ...]:
        """Index in arrays [..., line, bead], of slices where that can be, which copy nothing."""
        if beads.lines is None:
            return (..., beads.rows)
        if self.edges and self.open_row:
            return (..., slice(beads.lines[0], beads.lines[-1] + 1), beads.rows)
        return (..., np.array(beads.lines, dtype=np.int64), beads.rows)

    # --- the graph of links across ------------------------------------------------------------------------------------

    @cached_property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Pairs of lines that links across tie, from 0 with chains first, the lower number first; none of others."""
        if self.first is None or self.second is None or self.first.lines is None or self.second.lines is None:
            return ()
        return tuple(zip(self.first.lines, self.second.lines, strict=True))

    @cached_property
    def open_row(self) -> bool:
        """Whether the chains stand in a row, each tied to the next."""
        return self.edges == tuple((chain, chain + 1) for chain in range(len(self.edges)))

    @property
    def shape(self) -> str:
        """Words for the shape of the graph; empty for an open row."""
        chains = 1 + max((higher for _, higher in self.edges), default=0)
        if self.grid is not None:
            return f"lattice of {self.grid[0]} x {self.grid[1]}"
        if self.edges == tuple(sorted([(chain, chain + 1) for chain in range(chains - 1)] + [(0, chains - 1)])):
            return "ring"
        return "" if self.open_row else f"{len(self.edges)} pairs of chains"

    def acts(self, beads: int) -> Flags:
        """Whether a link ties the atoms of an edge, [edge, row], in chains of so many beads."""
        shape = len(self.edges), beads
        return np.broadcast_to(np.asarray(laws.force(self.law, np.ones(shape))) != 0.0, shape)

    def of_edges(self, values: Any) -> Floats:
        """Largest value of each edge, [edge], from a number or [edge, row]."""
        return np.asarray(np.broadcast_to(np.max(values, axis=-1) if np.ndim(values) else values, len(self.edges)))

    def counted_on(self, chains: int, lines: int) -> "Links":
        """Links whose lines of atoms count on after a number of other lines behind the chains."""
        edges = (tuple(n if n < chains else n + lines for n in edge) for edge in self.edges)
        return Links.across(self.name, self.law, tuple((lower, higher) for lower, higher in edges), self.grid)


@functools.lru_cache(maxsize=16)
def partners(edges: tuple[tuple[int, int], ...], chains: int, side: int) -> list[tuple[Integers, Integers]]:
    """Edges of every chain, [chain], to others of lower (side -1) or higher number, and the chains at their ends.

    As many pairs as any chain has; where a chain has fewer, its edge is -1 and its partner itself.
    """
    pairs: list[list[tuple[int, int]]] = [[] for _ in range(chains)]
    for number, (lower, higher) in enumerate(edges):
        end, partner = (higher, lower) if side < 0 else (lower, higher)
        pairs[end].append((number, partner))
    width = max(map(len, pairs), default=0)
    table = np.array(
        [[*ends, *[(-1, chain)] * (width - len(ends))] for chain, ends in enumerate(pairs)], dtype=np.int64
    )
    return [(table[:, place, 0], table[:, place, 1]) for place in range(width)]


def largest_eigenvalue(tied: Links, chains: int, stiffness: Floats | None = None) -> float:
    """Largest eigenvalue of the graph's Laplacian: 2 for two chains, below 4 for any open row.

    Args:
        tied: links between chains.
        chains: number of chains.
        stiffness: weights of the edges, [edge]; 1 if none are given.

    Returns:
        With more than `DENSE` chains, other than in an open row of weights 1, a bound from above: the largest sum of
        the weights at the two ends of an edge (Anderson & Morley, Linear Multilinear Algebra 18, 1985).
    """
    if stiffness is None and tied.open_row and len(tied.edges) == chains - 1:
        return 2.0 - 2.0 * math.cos(math.pi * (chains - 1) / chains)
    weight = np.ones(len(tied.edges)) if stiffness is None else stiffness
    lower, higher = np.array(tied.edges, dtype=np.int64).reshape(-1, 2).T
    at_chain = np.bincount(lower, weight, chains) + np.bincount(higher, weight, chains)
    if chains > DENSE:
        return float(np.max(at_chain[lower] + at_chain[higher], initial=0.0))
    laplacian = np.diag(at_chain)
    np.subtract.at(laplacian, (lower, higher), weight)
    np.subtract.at(laplacian, (higher, lower), weight)
    return float(np.linalg.eigvalsh(laplacian)[-1])
