"""Links between beads, along a chain, across chains and to the ground, each with a law of force.

The strain of a link is how far its first bead has come towards, and into, its second, along the chain; the law's force
drives the first back and the second forward. All of the equation of motion is here: what else is computed, such as
energy or acceleration, is a sum over links.

Arrays are [..., chain, bead]. Functions of arrays that hold only some rows take ``first``, the bead with which the last
axis begins: a law that differs from link to link must know which ones it sees.
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
        name: what they are to a user, such as "coupling".
        law: of every one of them.
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
        """Of each link, from displacements [..., chain, bead]."""
        raise NotImplementedError

    def on(self, rows: slice | Integers) -> Self:
        """The links among chosen rows, which count from 0; each is taken to be next to the one before."""
        if not laws.differs(self.law):
            return self
        return replace(self, law=laws.at(self.law, Ellipsis, self._links_of(rows)))

    def mirrored(self) -> Self:
        """The links with the numbers of the beads reversed."""
        if not laws.differs(self.law):
            return self
        return replace(self, law=laws.at(self.law, Ellipsis, slice(None, None, -1)))

    def at(self, time: Any) -> Self:
        """The links at a time, [...]; their law then does not depend on it."""
        if not laws.varies(self.law):
            return self
        return replace(self, law=self.law.now(np.asarray(time)[..., np.newaxis, np.newaxis]))  # type: ignore[attr-defined]

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
        """Stored in each link."""
        return np.asarray(laws.energy(self._seen(displacement, first), self.strain(displacement)))

    def force(self, displacement: Floats, first: int = 1) -> Floats:
        """Of each link."""
        return np.asarray(laws.force(self._seen(displacement, first), self.strain(displacement)))

    def force_rate(self, displacement: Floats, velocity: Floats) -> Floats:
        """How fast the force of each link changes."""
        law: Any = self._seen(displacement, 1)
        s = self.strain(displacement)
        rate = np.asarray(laws.stiffness(law, s) * self.rate(velocity))
        return rate + law.change(s, *law) if hasattr(law, "change") else rate

    def damping(self, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
        """Of each link with a law of damping: its force, which is 0 at rest."""
        law = self._seen(displacement, first)
        return np.asarray(dashpot.damping(law, self.strain(displacement), self.rate(velocity)))

    def damping_rate(self, displacement: Floats, velocity: Floats, acceleration: Floats, first: int = 1) -> Floats:
        """How fast that force changes, but for jumps."""
        law, s = self._seen(displacement, first), self.strain(displacement)
        return np.asarray(dashpot.change(law, s, self.rate(velocity), self.rate(acceleration)))

    def given(self, displacement: Floats, first: int = 1) -> Floats:
        """What each dashpot has given in time since there was no strain, but for tension that was cut."""
        law = self._seen(displacement, first)
        return np.asarray(law.impulse(self.strain(displacement), *law))  # type: ignore[attr-defined]

    def rate(self, velocity: Floats) -> Floats:
        """Of the strain of each link, which is linear in the displacements, but for a constant."""
        return self.strain(velocity) - self.strain(np.zeros_like(velocity))

    def _seen(self, displacement: Floats, first: int) -> Law:
        """The law of the links among the beads of an array."""
        return self.on(slice(first - 1, first - 1 + displacement.shape[-1])).law

    def _links_of(self, rows: slice | Integers) -> slice | Integers:
        return rows


@dataclass(frozen=True, eq=False)
class Along(Link):
    """Each bead with the next of its chain; [..., chain, contact], contact i being that of beads i and i + 1.

    Attributes:
        gap: clear distance at rest.
    """

    gap: float = 0.0

    def strain(self, displacement: Floats) -> Floats:
        """Overlap of each bead with the next; negative where they are apart."""
        return displacement[..., :-1] - displacement[..., 1:] - self.gap

    def overlap(self, displacement: Floats, first: int = 1) -> Floats:
        """Overlap of each bead with the next, that at rest included."""
        return np.asarray(self.strain(displacement) + laws.rest(self._seen(displacement, first)))

    def drive(self, total: Floats, force: Floats) -> None:
        """Push beads of higher numbers forward, of lower ones back."""
        total[..., 1:] += force
        total[..., :-1] -= force

    def shared(self, total: Floats, energy: Floats) -> None:
        """Half of every contact's energy for either of its beads."""
        total[..., 1:] += 0.5 * energy
        total[..., :-1] += 0.5 * energy

    def _links_of(self, rows: slice | Integers) -> slice | Integers:
        return slice(rows.start, rows.stop - 1) if isinstance(rows, slice) else rows[:-1]


@dataclass(frozen=True, eq=False)
class Across(Link):
    """Beads of one row in two chains, for every row; [..., edge, row]. The law's force must be odd in the strain.

    Attributes:
        edges: pairs of chains, counted from 0, the lower number first.
        grid: rows and columns in which the chains stand, numbered row by row, where they are a lattice.
    """

    edges: tuple[tuple[int, int], ...] = ()
    grid: tuple[int, int] | None = None

    def strain(self, displacement: Floats) -> Floats:
        """How far the bead of the lower chain is ahead of the other."""
        lower, higher = self._ends
        return np.asarray(displacement[..., lower, :] - displacement[..., higher, :])

    def drive(self, total: Floats, force: Floats) -> None:
        """Pull the chain of lower number back, and the other forward."""
        lower, higher = self._ends
        if isinstance(lower, slice):
            total[..., lower, :] -= force
            total[..., higher, :] += force
            return
        for edge, (one, other) in enumerate(self.edges):
            total[..., one, :] -= force[..., edge, :]
            total[..., other, :] += force[..., edge, :]

    def add_chain_energy(self, total: Floats, energy: Floats) -> None:
        """Half of the energy of every spring for either of its chains."""
        springs = np.sum(energy, axis=-1)
        for end in (0, 1):
            for edge, ends in enumerate(self.edges):
                total[..., ends[end]] += 0.5 * springs[..., edge]

    def of_edges(self, values: Any) -> Floats:
        """Largest value of each edge, [edge], from a number or [edge, row]."""
        return np.asarray(np.broadcast_to(np.max(values, axis=-1) if np.ndim(values) else values, len(self.edges)))

    def counted_on(self, chains: int, lines: int) -> Self:
        """The same links where so many other lines of atoms stand between the chains and the lines that they tie."""
        shift = [[n if n < chains else n + lines for n in edge] for edge in self.edges]
        return replace(self, edges=tuple((lower, higher) for lower, higher in shift))

    @cached_property
    def open_row(self) -> bool:
        """Whether the chains stand in a row, each tied to the next."""
        return self.edges == tuple((chain, chain + 1) for chain in range(len(self.edges)))

    @property
    def shape(self) -> str:
        """What the graph is to a reader; empty for an open row."""
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
    found: list[list[tuple[int, int]]] = [[] for _ in range(chains)]
    for number, (lower, higher) in enumerate(edges):
        here, there = (higher, lower) if side < 0 else (lower, higher)
        found[here].append((number, there))
    width = max(map(len, found), default=0)
    table = np.array(
        [[*ends, *[(-1, chain)] * (width - len(ends))] for chain, ends in enumerate(found)], dtype=np.int64
    )
    return [(table[:, place, 0], table[:, place, 1]) for place in range(width)]


@dataclass(frozen=True, eq=False)
class Ground(Link):
    """Each bead with its place at rest; [..., chain, bead].

    Attributes:
        side: 1 where the strain grows towards higher bead numbers, -1 where towards lower ones.
        gap: displacement at which the strain is 0.
    """

    side: float = 1.0
    gap: float = 0.0

    def strain(self, displacement: Floats) -> Floats:
        """The displacement itself, of all but walls."""
        return self.side * displacement - self.gap

    def rate(self, velocity: Floats) -> Floats:
        """The velocity itself, likewise."""
        return self.side * velocity

    def drive(self, total: Floats, force: Floats) -> None:
        """Pull every bead back."""
        total -= self.side * force

    def shared(self, total: Floats, energy: Floats) -> None:
        """All of it for the bead."""
        total += energy


@dataclass(frozen=True, eq=False)
class Wall(Ground):
    """The last bead of each chain, or the first, with a wall at rest, by a law of contacts or of their dashpots.

    It only ever pushes, and lets no bead oscillate. Its law has the strength 0 for all other beads.
    """

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
