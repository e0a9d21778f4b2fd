"""Links between beads, along a chain, across chains and to the ground, each with a law of force.

The strain of a link is how far its first bead has come towards, and into, its second, along the chain; the law's force
drives the first back and the second forward. All of the equation of motion is here: what else is computed, such as
energy or acceleration, is a sum over links.

Arrays are [..., chain, bead]. Functions of arrays that hold only some rows take ``first``, the bead with which the last
axis begins: a law that differs from link to link must know which ones it sees.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws
from lammps_inputs.laws import Law

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Link:
    """Links of one kind with one law.

    Attributes:
        name: what they are to a user, such as "coupling".
        law: of every one of them.
    """

    name: str
    law: Law

    def strain(self, displacement: Floats) -> Floats:
        """Of each link, from displacements [..., chain, bead]."""
        raise NotImplementedError

    def on(self, first: int, beads: int) -> Self:
        """The links among some rows, which begin with bead ``first``."""
        if not laws.differs(self.law):
            return self
        return replace(self, law=laws.at(self.law, Ellipsis, self._within(first, beads)))

    def energy(self, displacement: Floats, first: int = 1) -> Floats:
        """Stored in each link."""
        law = self.on(first, displacement.shape[-1]).law
        return np.asarray(laws.energy(law, self.strain(displacement)))

    def add_force(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add the force on every bead to ``total``, of the shape of the displacements."""
        raise NotImplementedError

    def add_bead_energy(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add every link's energy to ``total``, [..., chain, bead]: two beads that it joins have half each."""
        raise NotImplementedError

    def add_energy(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add the energy of every chain's links to ``total``, [..., chain]; two chains that are tied have half each."""
        total += np.sum(self.energy(displacement, first), axis=-1)

    def _within(self, first: int, beads: int) -> slice:
        return slice(first - 1, first - 1 + beads)


@dataclass(frozen=True)
class Along(Link):
    """Each bead with the next of its chain; [..., chain, contact], contact i being that of beads i and i + 1.

    Attributes:
        gap: clear distance at rest.
    """

    gap: float = 0.0

    def strain(self, displacement: Floats) -> Floats:
        """Overlap of each bead with the next; negative where they are apart."""
        return displacement[..., :-1] - displacement[..., 1:] - self.gap

    def add_force(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add the force on every bead."""
        push = laws.force(self.on(first, displacement.shape[-1]).law, self.strain(displacement))
        total[..., 1:] += push
        total[..., :-1] -= push

    def add_bead_energy(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add half of every contact's energy to either of its beads."""
        half = 0.5 * self.energy(displacement, first)
        total[..., 1:] += half
        total[..., :-1] += half

    def _within(self, first: int, beads: int) -> slice:
        return slice(first - 1, first - 2 + beads)


@dataclass(frozen=True)
class Across(Link):
    """Beads of one row in two chains, for every row; [..., edge, row]. The law's force must be odd in the strain.

    Attributes:
        edges: pairs of chains, counted from 0, the lower number first.
    """

    edges: tuple[tuple[int, int], ...] = ()

    def strain(self, displacement: Floats) -> Floats:
        """How far the bead of the lower chain is ahead of the other."""
        lower, higher = self._ends
        return np.asarray(displacement[..., lower, :] - displacement[..., higher, :])

    def add_force(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add the force on every bead."""
        pull = laws.force(self.on(first, displacement.shape[-1]).law, self.strain(displacement))
        lower, higher = self._ends
        if isinstance(lower, slice):
            total[..., lower, :] -= pull
            total[..., higher, :] += pull
            return
        for edge, (one, other) in enumerate(self.edges):
            total[..., one, :] -= pull[..., edge, :]
            total[..., other, :] += pull[..., edge, :]

    def add_bead_energy(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add half of every spring's energy to either of its beads."""
        half = 0.5 * self.energy(displacement, first)
        for edge, ends in enumerate(self.edges):
            for chain in ends:
                total[..., chain, :] += half[..., edge, :]

    def add_energy(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add half of the energy of every spring to either of its chains."""
        springs = np.sum(self.energy(displacement, first), axis=-1)
        for end in (0, 1):
            for edge, ends in enumerate(self.edges):
                total[..., ends[end]] += 0.5 * springs[..., edge]

    @cached_property
    def open_row(self) -> bool:
        """Whether the chains stand in a row, each tied to the next."""
        return self.edges == tuple((chain, chain + 1) for chain in range(len(self.edges)))

    @cached_property
    def _ends(self) -> tuple[Any, Any]:
        """Lower and higher chains, to index with; slices where that can be, which copy nothing."""
        count = len(self.edges)
        if self.open_row:
            return slice(0, count), slice(1, count + 1)
        ends = np.array(self.edges).reshape(count, 2)
        return ends[:, 0], ends[:, 1]

    def partners(self, chains: int, side: int) -> NDArray[np.int64]:
        """Edges to the chains of lower (side -1) or higher number, [chain, place]; -1 where there are no more."""
        found: list[list[int]] = [[] for _ in range(chains)]
        for edge, (lower, higher) in enumerate(self.edges):
            found[higher if side < 0 else lower].append(edge)
        width = max(map(len, found), default=0)
        return np.array([edges + [-1] * (width - len(edges)) for edges in found], dtype=np.int64)


@dataclass(frozen=True)
class Ground(Link):
    """Each bead with its place at rest; [..., chain, bead]."""

    def strain(self, displacement: Floats) -> Floats:
        """The displacement itself."""
        return displacement

    def add_force(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add the force on every bead."""
        total -= laws.force(self.on(first, displacement.shape[-1]).law, displacement)

    def add_bead_energy(self, total: Floats, displacement: Floats, first: int = 1) -> None:
        """Add the energy of every bead's link."""
        total += self.energy(displacement, first)


def largest_eigenvalue(across: Across, chains: int) -> float:
    """Largest eigenvalue of the graph's Laplacian: 2 for two chains, below 4 for any open row."""
    if across.open_row and len(across.edges) == chains - 1:
        return 2.0 - 2.0 * math.cos(math.pi * (chains - 1) / chains)
    laplacian = np.zeros((chains, chains))
    for one, other in across.edges:
        laplacian[one, other] -= 1.0
        laplacian[other, one] -= 1.0
        laplacian[one, one] += 1.0
        laplacian[other, other] += 1.0
    return float(np.linalg.eigvalsh(laplacian)[-1])
