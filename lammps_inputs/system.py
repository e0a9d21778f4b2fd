"""Beads, the links between them, and what sets them in motion: the equations of motion, dimensionless at V = 1.

What follows from a system is in `lammps_inputs.physics`; where LAMMPS has its beads, in `lammps_inputs.layout`.

| paper              | here                      | unit                      |
|--------------------|---------------------------|---------------------------|
| N                  | ``chains``                | -                         |
| epsilon * alpha    | ``physics.kappa``         | m / T**2                  |
| D                  | ``physics.gap``           | L                         |
| V                  | largest of the excitations | L / T; 1 by construction |
"""

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lammps_inputs.facts import Fact
from lammps_inputs.links import Links
from lammps_inputs.loads import Load, Motion


class Noun(NamedTuple):
    """What the atoms of a line are called: one of them, and several."""

    singular: str
    plural: str


@dataclass(frozen=True, eq=False)
class FurtherLine:
    """Line of atoms beside a chain, each tied to its bead, such as a mass inside each bead.

    Attributes:
        mass: [bead], in units of the reference bead's; 0 where there is no atom.
        chain: its chain, counted from 0.
        noun: what its atoms are called.
    """

    mass: NDArray[np.float64]
    chain: int
    noun: Noun

    def on(self, rows: NDArray[np.int64] | slice) -> "FurtherLine":
        """The line at chosen rows, [row] counted from 0."""
        return replace(self, mass=self.mass[rows])

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last mass."""
        if not isinstance(other, FurtherLine):
            return False
        return (self.chain, self.noun) == (other.chain, other.noun) and np.array_equal(self.mass, other.mass)


@dataclass(frozen=True, eq=False)
class Start:
    """Where atoms are at the start, and how fast they move, beside kicks and given motions.

    Attributes:
        displacement: from the places at rest, [line, bead] in units of L.
        velocity: [line, bead] in units of V; kicks add to it.
    """

    displacement: NDArray[np.float64]
    velocity: NDArray[np.float64]

    def on(self, rows: NDArray[np.int64] | slice) -> "Start":
        """The start of chosen rows, [row] counted from 0."""
        return Start(self.displacement[:, rows], self.velocity[:, rows])

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number."""
        if not isinstance(other, Start):
            return False
        return all(map(np.array_equal, (self.displacement, self.velocity), (other.displacement, other.velocity)))

    def __hash__(self) -> int:
        return hash(self.displacement.shape)


@dataclass(frozen=True, kw_only=True, eq=False)
class System:
    """Beads, the links between them, and their kicks, so that the fastest starts at 1.

    Examples:
        >>> system = granchain.load("two-chains").problem().system
        >>> system.chains, system.beads, system.kicks
        (2, 120, ((1, 1, 1.0),))
        >>> [link.name for link in system.links], len(system.couplings)
        (['contacts', 'coupling'], 1)
    """

    chains: int
    beads: int
    kicks: tuple[tuple[int, int, float], ...]
    """(chain, bead, velocity), counted from 1; the largest |velocity| is 1."""
    links: tuple[Links, ...]
    """All forces there are: contacts first, links that tie further lines of atoms last."""
    mass: float | NDArray[np.float64] = 1.0
    """1 where all beads have the reference bead's, else [chain, bead]."""
    further_lines: tuple[FurtherLine, ...] = ()
    """Lines of atoms that are no beads; their numbers count on from those of the chains."""
    lacks: frozenset[Fact] = frozenset()
    """Facts that do not hold."""
    loads: tuple[Load, ...] = ()
    """Forces on beads from outside, over time."""
    motions: tuple[Motion, ...] = ()
    """Beads whose motion is given."""
    dampers: tuple[Links, ...] = ()
    """Forces against velocities: links with laws of damping."""
    start: Start | None = None
    """Displacements and velocities at the start; None where all atoms are at rest but for kicks and given motions."""

    def __eq__(self, other: object) -> bool:
        """Whether all is the same, to the last number of every array."""
        if type(self) is not type(other):
            return False
        pairs = ((getattr(self, field.name), getattr(other, field.name)) for field in fields(self))
        return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else _same(a, b) for a, b in pairs)

    def __hash__(self) -> int:
        return hash((type(self), self.chains, self.beads, self.kicks, self.links))

    def holds(self, fact: Fact) -> bool:
        """Whether a fact is true of this system."""
        return fact not in self.lacks

    @cached_property
    def along(self) -> tuple[Links, ...]:
        """The links along the chains."""
        return tuple(link for link in self.links if link.kind == "along")

    @cached_property
    def closing(self) -> tuple[Links, ...]:
        """The links that close the chains to rings; none where chains have ends."""
        return tuple(link for link in self.links if link.kind == "closing")

    @cached_property
    def contacts(self) -> tuple[Links, ...]:
        """The links between neighbouring beads of a chain, those that close rings included."""
        return (*self.along, *self.closing)

    @cached_property
    def across(self) -> tuple[Links, ...]:
        """The links across the lines of atoms: the couplings of chains, then the ties of further lines."""
        return tuple(link for link in self.links if link.kind == "across")

    @cached_property
    def links_of_chains(self) -> tuple[Links, ...]:
        """The links but for the ties of further lines of atoms."""
        return tuple(link for link in self.links if not self.is_tie(link))

    @cached_property
    def couplings(self) -> tuple[Links, ...]:
        """The links across that couple chains with each other."""
        return tuple(link for link in self.across if not self.is_tie(link))

    @cached_property
    def ties(self) -> tuple[Links, ...]:
        """The links across that tie further lines of atoms."""
        return tuple(link for link in self.across if self.is_tie(link))

    def among(self, links: Iterable[Links], first: int, width: int) -> tuple[Links, ...]:
        """Those of some links that an array of consecutive beads holds: all but those at ends that it does not.

        Args:
            links: links of the system.
            first: number of the first of these beads.
            width: number of beads.
        """
        at_wall = {-1.0: 1, 1.0: self.beads}
        every = width == self.beads
        return tuple(
            x
            for x in links
            if (x.kind != "wall" or first <= at_wall[x.side] < first + width) and (x.kind != "closing" or every)
        )

    def on(self, rows: NDArray[np.int64]) -> "System":
        """The system at chosen rows, [row] counted from 0; kicks, loads and motions keep the numbers of their beads."""
        return replace(
            self,
            beads=len(rows),
            links=tuple(link.on(rows) for link in self.links),
            dampers=tuple(link.on(rows) for link in self.dampers),
            mass=self.mass if isinstance(self.mass, float) else self.mass[:, rows],
            further_lines=tuple(line.on(rows) for line in self.further_lines),
            start=None if self.start is None else self.start.on(rows),
        )

    def is_tie(self, link: Links) -> bool:
        """Whether a link ties atoms of further lines, not only beads of chains."""
        return any(higher >= self.chains for _, higher in link.edges)

    @cached_property
    def chain_of_line(self) -> NDArray[np.int64]:
        """Chain of each line of atoms, [line], all counted from 0: the chains themselves, then further lines."""
        return np.array([*range(self.chains), *(line.chain for line in self.further_lines)])

    @cached_property
    def lines_by_noun(self) -> dict[Noun, NDArray[np.int64]]:
        """Noun of atoms that are no beads -> their lines, [line], counted from 0 with the chains first."""
        nouns = dict.fromkeys(line.noun for line in self.further_lines)
        places = {noun: [n for n, line in enumerate(self.further_lines) if line.noun == noun] for noun in nouns}
        return {noun: self.chains + np.array(of_noun) for noun, of_noun in places.items()}

    def atom_at_bead(self, line: int) -> tuple[str, int]:
        """Noun of the atoms of a line, from 0, and their number among those at their bead; "" and 0 of a chain."""
        before = [(other.chain, other.noun) for other in self.further_lines[: max(0, line + 1 - self.chains)]]
        return (before[-1][1].singular, before.count(before[-1])) if before else ("", 0)

    @property
    def others(self) -> str:
        """Nouns of all atoms that are no beads, such as "resonators"; empty where there are none."""
        return " and ".join(noun.plural for noun in self.lines_by_noun)

    @cached_property
    def ground(self) -> tuple[Links, ...]:
        """The links of beads with their places at rest, weights apart."""
        return tuple(link for link in self.links if link.kind == "ground" and not link.law.constant)

    @cached_property
    def weights(self) -> tuple[Links, ...]:
        """The weights of beads that fall; none where they hang or stand at rest."""
        return tuple(link for link in self.links if link.kind == "ground" and link.law.constant)

    @cached_property
    def walls(self) -> tuple[Links, ...]:
        """The links of beads at the ends with walls."""
        return tuple(link for link in self.links if link.kind == "wall")


def _same(first: object, second: object) -> bool:
    return not isinstance(second, np.ndarray) and first == second
