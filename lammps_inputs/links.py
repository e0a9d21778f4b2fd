"""Links between beads, along a chain, across chains and to the ground, each with a law of force.

The strain of a link is how far its first bead has come towards, and into, its second, along the chain; the law's force
drives the first back and the second forward. All of the equation of motion is here: what else is computed, such as
energy or acceleration, is a sum over links.

Displacements (in L), velocities (in V) and accelerations (in V / T) of beads are [..., chain, bead]. Forces (in
m V / T) and energies (in m V**2) of links are [..., chain, contact], [..., edge, row] or [..., chain, bead], in short
[..., link]. Functions of arrays that hold only some rows take ``first``, the bead with which the last axis begins, by
which they choose the parameters of a law that differs from link to link.
"""

import functools
import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.laws import Law, dashpot

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

DENSE = 300
"""Chains up to which eigenvalues of a graph are computed."""


@dataclass(frozen=True, eq=False)
class Link:
    """Links of one kind with one law.

    Attributes:
        name: name for users, such as "coupling".
        law: law of every link.
    """

    name: str
    law: Law

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number of every array."""
        if not isinstance(other, type(self)) or type(self.law) is not type(other.law):
            return False
        named = [field.name for field in fields(self) if field.name != "law"]
        return all(getattr(self, name) == getattr(other, name) for name in named) and all(
            map(np.array_equal, self.law, other.law)
        )

    def __hash__(self) -> int:
        return hash((type(self), self.name, type(self.law)))

    def strain(self, displacement: Floats) -> Floats:
        """Strain of each link, [..., link], in units of L, at displacements [..., chain, bead]."""
        raise NotImplementedError

    def lines_among(self, chains: int) -> slice:
        """Lines of atoms, the chains first, among which these links may be: the chains alone."""
        return slice(chains)

    def on(self, rows: slice | Integers) -> Self:
        """Links among chosen rows, [row], counted from 0; each is taken to be next to the one before."""
        if not laws.differs(self.law):
            return self
        return replace(self, law=laws.at(self.law, Ellipsis, self._links_of(rows)))

    def mirrored(self) -> Self:
        """The links with the numbers of the beads reversed."""
        if not laws.differs(self.law):
            return self
        return replace(self, law=laws.at(self.law, Ellipsis, slice(None, None, -1)))

    def at(self, time: Any) -> Self:
        """Links at a time, a number or [...]; their law then does not depend on time."""
        if not self.law.varies:
            return self
        return replace(self, law=self.law.now(np.asarray(time)[..., np.newaxis, np.newaxis]))

    def drive(self, total: Floats, force: Floats) -> None:
        """Add to ``total``, [..., chain, bead], what forces of the links do to the beads."""
        raise NotImplementedError

    def shared(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain, bead], energies of the links, of which two beads have half each."""
        raise NotImplementedError

    def add_chain_energy(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain], energies of the links; two chains that are tied have half each."""
        total += np.sum(energy, axis=-1)

    def energy(self, displacement: Floats, first: int = 1) -> Floats:
        """Energy stored in each link, [..., link], at displacements [..., chain, bead]."""
        return np.asarray(laws.energy(self._seen(displacement, first), self.strain(displacement)))

    def force(self, displacement: Floats, first: int = 1) -> Floats:
        """Force of each link, [..., link], at displacements [..., chain, bead]."""
        return np.asarray(laws.force(self._seen(displacement, first), self.strain(displacement)))

    def force_rate(self, displacement: Floats, velocity: Floats) -> Floats:
        """Rate of change of the force of each link, [..., link], in units of m V / T**2."""
        law: Any = self._seen(displacement, 1)
        s = self.strain(displacement)
        return np.asarray(laws.stiffness(law, s) * self.rate(velocity) + law.change(s, *law))

    def damping(self, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
        """Force of each dashpot, [..., link], which is 0 at rest."""
        law = self._seen(displacement, first)
        return np.asarray(dashpot.damping(law, self.strain(displacement), self.rate(velocity)))

    def damping_rate(self, displacement: Floats, velocity: Floats, acceleration: Floats, first: int = 1) -> Floats:
        """Rate of change of the force of each dashpot, [..., link], in units of m V / T**2, but for jumps."""
        law, s = self._seen(displacement, first), self.strain(displacement)
        return np.asarray(dashpot.change(law, s, self.rate(velocity), self.rate(acceleration)))

    def given(self, displacement: Floats, first: int = 1) -> Floats:
        """Impulse of each dashpot, [..., link], in units of m V, since its strain was 0, as if no tension were cut."""
        law = self._seen(displacement, first)
        return np.asarray(law.impulse(self.strain(displacement), *law))

    def rate(self, velocity: Floats) -> Floats:
        """Rate of the strain of each link, [..., link], in units of V; the strain is linear in the displacements."""
        return self.strain(velocity) - self.strain(np.zeros_like(velocity))

    def _seen(self, displacement: Floats, first: int) -> Law:
        """Law of the links among the beads of an array."""
        return self.on(slice(first - 1, first - 1 + displacement.shape[-1])).law

    def _links_of(self, rows: slice | Integers) -> slice | Integers:
        return rows


@dataclass(frozen=True, eq=False)
class Along(Link):
    """Links of each bead with the next of its chain, [..., chain, contact]; contact i is that of beads i and i + 1.

    Attributes:
        gap: clear distance at rest.
    """

    gap: float = 0.0

    def strain(self, displacement: Floats) -> Floats:
        """Overlap of each bead with the next, [..., chain, contact], above that at rest; negative if less."""
        return displacement[..., :-1] - displacement[..., 1:] - self.gap

    def overlap(self, displacement: Floats, first: int = 1) -> Floats:
        """Overlap of each bead with the next, [..., chain, contact], that at rest included."""
        return np.asarray(self.strain(displacement) + self._seen(displacement, first).rest)

    def drive(self, total: Floats, force: Floats) -> None:
        """Add to ``total``, [..., chain, bead]: contacts push beads of higher numbers forward, of lower ones back."""
        total[..., 1:] += force
        total[..., :-1] -= force

    def shared(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain, bead], half of every contact's energy for either of its beads."""
        total[..., 1:] += 0.5 * energy
        total[..., :-1] += 0.5 * energy

    def _links_of(self, rows: slice | Integers) -> slice | Integers:
        return slice(rows.start, rows.stop - 1) if isinstance(rows, slice) else rows[:-1]


@dataclass(frozen=True, eq=False)
class Across(Link):
    """Links of the atoms of a row in two lines, [..., edge, row]. The law's force must be odd in the strain.

    Attributes:
        edges: pairs of chains, or of further lines of atoms after them, counted from 0, the lower number first.
        grid: rows and columns in which the chains stand, numbered row by row, where they are a lattice.
    """

    edges: tuple[tuple[int, int], ...] = ()
    grid: tuple[int, int] | None = None

    def lines_among(self, chains: int) -> slice:  # noqa: ARG002
        """Lines of atoms, the chains first, among which these links may be: all of them."""
        return slice(None)

    def strain(self, displacement: Floats) -> Floats:
        """Displacement of the bead of the lower chain relative to the other, [..., edge, row]."""
        lower, higher = self._ends
        return np.asarray(displacement[..., lower, :] - displacement[..., higher, :])

    def drive(self, total: Floats, force: Floats) -> None:
        """Add to ``total``, [..., chain, bead]: springs pull the chain of lower number back, the other forward."""
        lower, higher = self._ends
        if isinstance(lower, slice):
            total[..., lower, :] -= force
            total[..., higher, :] += force
            return
        for edge, (first, second) in enumerate(self.edges):
            total[..., first, :] -= force[..., edge, :]
            total[..., second, :] += force[..., edge, :]

    def add_chain_energy(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain], half of the energy of every spring for either of its chains."""
        springs = np.sum(energy, axis=-1)
        for end in (0, 1):
            for edge, ends in enumerate(self.edges):
                total[..., ends[end]] += 0.5 * springs[..., edge]

    def acts(self, beads: int) -> NDArray[np.bool_]:
        """Whether a link ties the atoms of an edge, [edge, row], in chains of so many beads."""
        shape = len(self.edges), beads
        return np.broadcast_to(np.asarray(laws.force(self.law, np.ones(shape))) != 0.0, shape)

    def of_edges(self, values: Any) -> Floats:
        """Largest value of each edge, [edge], from a number or [edge, row]."""
        return np.asarray(np.broadcast_to(np.max(values, axis=-1) if np.ndim(values) else values, len(self.edges)))

    def counted_on(self, chains: int, lines: int) -> Self:
        """Links whose lines of atoms count on after a number of other lines behind the chains."""
        shift = [[n if n < chains else n + lines for n in edge] for edge in self.edges]
        return replace(self, edges=tuple((lower, higher) for lower, higher in shift))

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

    @cached_property
    def _ends(self) -> tuple[Any, Any]:
        """Lower and higher chains, to index with; slices where that can be, which copy nothing."""
        count = len(self.edges)
        if self.open_row:
            return slice(0, count), slice(1, count + 1)
        ends = np.array(self.edges).reshape(count, 2)
        return ends[:, 0], ends[:, 1]


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


@dataclass(frozen=True, eq=False)
class Ground(Link):
    """Links of each bead with its place at rest, [..., chain, bead].

    Attributes:
        side: 1 where the strain grows towards higher bead numbers, -1 where towards lower ones.
        gap: displacement at which the strain is 0.

    Examples:
        >>> [springs] = granchain.load("beats-on-a-foundation").system.ground
        >>> bed = Ground("bed", springs.law, gap=0.5)
        >>> bed.strain(np.array([[0.7, 1.5]]))  # of displacements, [chain, bead], in units of L
        array([[0.2, 1. ]])
    """

    side: float = 1.0
    gap: float = 0.0

    def strain(self, displacement: Floats) -> Floats:
        """Displacement of each bead from the point of zero strain, [..., chain, bead]."""
        return self.side * displacement - self.gap

    def rate(self, velocity: Floats) -> Floats:
        """Velocity of each bead in the direction of growing strain, [..., chain, bead]."""
        return self.side * velocity

    def drive(self, total: Floats, force: Floats) -> None:
        """Add to ``total``, [..., chain, bead]: the links pull every bead back."""
        total -= self.side * force

    def shared(self, total: Floats, energy: Floats) -> None:
        """Add to ``total``, [..., chain, bead], all of the energy of each link for its bead."""
        total += energy


@dataclass(frozen=True, eq=False)
class Weights(Ground):
    """Weights of the beads: forces from outside that do not depend on the displacement, by the law of weights."""

    def mirrored(self) -> Self:
        """The weights in the mirror, in which they act towards lower bead numbers."""
        law: Any = super().mirrored().law
        return replace(self, law=replace(law, acceleration=-law.acceleration))

    def shared(self, total: Floats, energy: Floats) -> None:
        """Add nothing: what weights do is work from outside, not energy of a bead."""


@dataclass(frozen=True, eq=False)
class Wall(Ground):
    """Links of the last bead of each chain, or the first, with a wall at rest, by a law of contacts or of dashpots.

    It pushes, or pulls where contacts do, and lets no bead oscillate. Its law has the strength 0 for all other beads.

    Attributes:
        curved: whether its surface is as curved as the bead that meets it, as that of another bead; else it is flat.
    """

    curved: bool = False

    def mirrored(self) -> Self:
        """The wall at the other end."""
        return replace(super().mirrored(), side=-self.side)


def largest_eigenvalue(across: Across, chains: int, stiffness: Floats | None = None) -> float:
    """Largest eigenvalue of the graph's Laplacian: 2 for two chains, below 4 for any open row.

    Args:
        across: links between chains.
        chains: number of chains.
        stiffness: weights of the edges, [edge]; 1 if none are given.

    Returns:
        With more than `DENSE` chains, other than in an open row of weights 1, a bound from above: the largest sum of
        the weights at the two ends of an edge (Anderson & Morley, Linear Multilinear Algebra 18, 1985).
    """
    if stiffness is None and across.open_row and len(across.edges) == chains - 1:
        return 2.0 - 2.0 * math.cos(math.pi * (chains - 1) / chains)
    weight = np.ones(len(across.edges)) if stiffness is None else stiffness
    lower, higher = np.array(across.edges, dtype=np.int64).reshape(-1, 2).T
    at_chain = np.bincount(lower, weight, chains) + np.bincount(higher, weight, chains)
    if chains > DENSE:
        return float(np.max(at_chain[lower] + at_chain[higher], initial=0.0))
    laplacian = np.diag(at_chain)
    np.subtract.at(laplacian, (lower, higher), weight)
    np.subtract.at(laplacian, (higher, lower), weight)
    return float(np.linalg.eigvalsh(laplacian)[-1])
