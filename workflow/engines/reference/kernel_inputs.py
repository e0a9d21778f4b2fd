"""The terms of a system's equations of motion, as the compiled step reads them, and the numbers that they take.

Terms depend on which laws there are and on which of their parameters differ from link to link, not on any number: many
systems have the same.

Examples:
    >>> system = granchain.load("two-chains").problem().system
    >>> forces_of, parameters = kernel_inputs.make_terms(system, as_lammps=False, step=0.0)
    >>> forces_of.contacts[0].law.__name__, forces_of.contacts[0].strain
    ('Hertz', 'x[k - row_0] - x[k] - gap_1')
    >>> len(forces_of.names) == len(parameters)
    True
"""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import System, laws, physics
from lammps_inputs.laws import dashpot
from lammps_inputs.laws.in_time import TimeLaw
from lammps_inputs.links import Kind, Links

Floats = NDArray[np.float64]

STATES = "contact_state"
"""Source of the array of states of contacts."""

UNROLLED = 2
"""Distances to neighbours that the loop is written out for, which an open row has."""


@dataclass(frozen=True)
class Term:
    """A law in a loop over places k.

    Attributes:
        law: its class.
        strain_text, rate_text: source of both at k, with ``{x}`` and ``{v}`` for the arrays; empty of a law in time.
        parameters: source of each at k.
        over: array that the term is a loop over: distances to other beads, or the places of a law in time.
        sums: scratch array of three sums over distances, [sum, place].
        state_at: index of a contact's state in arrays of states, in brackets; empty of a law without one.
        row: of a wall, that of its bead, of the contact that closes a ring that of the first; empty of others.
        place: of these, indices in brackets of its force among those of the contacts; empty of others.
        behind: place of the bead behind a contact; empty of others.
        sign: source of a factor of what the law gives; empty of 1.
        time: source of the time, on which the law depends; empty of one that does not.
        x, v: names of the arrays of displacements and velocities that it reads.
    """

    law: Any
    strain_text: str
    rate_text: str
    parameters: tuple[str, ...]
    over: str = ""
    sums: str = ""
    state_at: str = ""
    row: str = ""
    place: tuple[str, ...] = ()
    behind: str = ""
    sign: str = ""
    time: str = ""
    x: str = "x"
    v: str = "v"

    @property
    def strain(self) -> str:
        """Source of the strain at k."""
        return self.strain_text.format(x=self.x)

    @property
    def rate(self) -> str:
        """Source of the rate of the strain at k."""
        return self.rate_text.format(v=self.v)

    def at_contact(self, array: str) -> str:
        """Source of the contact's entry in an array of one number for each state, of a law that has one."""
        return f"{array}{self.state_at}"


@dataclass(frozen=True)
class Terms:
    """All terms of a system; `names` are those of the parameters, in order, of which ``row`` is the length of a row.

    Attributes:
        contacts, across, ground, walls, closing: laws of force.
        dampers: laws of damping along, across and to the ground.
        wall_dampers, closing_dampers: those of walls, and of contacts that close rings.
        loads, motions: laws in time, of forces on beads and of the motion of beads whose motion is given.
        moved: array of the places of these beads; empty where there is none.
        inverse_mass: name of one over the masses; empty where all are 1.
        dashpots: how they act: as in LAMMPS with those of half a step before, in the kicks, or in the drifts.
        as_lammps: whether loads act as LAMMPS has them.
        bends: array of times at which stiffnesses or prescribed velocities change abruptly, where steps are split;
            empty if there are none.
        counts_work: whether the work of loads, motions and springs that vary is counted.
    """

    names: tuple[str, ...]
    row: str
    contacts: tuple[Term, ...]
    across: tuple[Term, ...]
    ground: tuple[Term, ...]
    walls: tuple[Term, ...]
    closing: tuple[Term, ...]
    dampers: tuple[tuple[Term, ...], ...]
    wall_dampers: tuple[Term, ...]
    closing_dampers: tuple[Term, ...]
    loads: tuple[Term, ...]
    motions: tuple[Term, ...]
    moved: str
    inverse_mass: str
    dashpots: Literal["none", "half step", "kick", "drift"]
    as_lammps: bool
    counts_work: bool
    bends: str

    @property
    def counts_lost(self) -> bool:
        """Whether what dashpots take is counted."""
        return self.dashpots in ("kick", "drift")

    @property
    def moved_with_loss(self) -> bool:
        """Whether dashpots act on beads whose motion is given, which is counted."""
        return self.counts_lost and self.counts_work and bool(self.motions)

    @property
    def with_state(self) -> tuple[Term, ...]:
        """Contacts and walls whose force depends on a state."""
        return tuple(term for term in (*self.contacts, *self.at_ends) if term.state_at)

    @property
    def at_ends(self) -> tuple[Term, ...]:
        """Walls, and contacts that close rings."""
        return (*self.walls, *self.closing)

    @property
    def dampers_at_ends(self) -> tuple[Term, ...]:
        """Dashpots of walls, and of contacts that close rings."""
        return (*self.wall_dampers, *self.closing_dampers)

    def per_mass_at(self, place: str) -> str:
        """Source of what makes a force at a place an acceleration; empty where all masses are 1."""
        return f" * {self.inverse_mass}[{place}]" if self.inverse_mass else ""

    @property
    def per_mass(self) -> str:
        """Source of what makes a force at k an acceleration."""
        return self.per_mass_at("k")

    @property
    def pushed_in_drifts(self) -> bool:
        """Whether loads or motions act while beads drift."""
        return bool(self.motions or (self.loads and not self.as_lammps))


def make_terms(system: System, *, as_lammps: bool, step: float) -> tuple[Terms, tuple[Any, ...]]:
    """The terms of a system and their parameters; with LAMMPS's step where masses depend on it."""
    taken = _Parameters(system)
    row, gap = taken.add("row", np.uint64(physics.lines(system))), taken.gap_of(system.along[0])
    between = f"{{x}}[k - {row}] - {{x}}[k] - {gap}", f"{{v}}[k - {row}] - {{v}}[k]"
    dampers = {kind: [link for link in system.dampers if link.kind == kind] for kind in get_args(Kind)}
    cut = any(dashpot.cut(link.law) for link in system.dampers)
    varying = [link.law.bends for link in system.ground if link.law.varies]
    bends = np.unique(np.concatenate([*varying, *(law.leaps for each in system.motions for law in each.laws), []]))
    inverse = _inverse_mass(system, step if as_lammps and physics.velocity_at_full_steps(system) else 0.0)
    terms = Terms(
        contacts=tuple(
            replace(taken.term(link.law, *between, first=2, state_at="[k]"), behind=f"k - {row}")
            for link in system.along
        ),
        across=taken.terms(system.across),
        ground=taken.terms((*system.ground, *system.weights)),
        walls=taken.terms(system.walls),
        closing=taken.terms(system.closing),
        dampers=(
            tuple(taken.term(link.law, *between, first=2) for link in dampers["along"]),
            *(taken.terms(dampers[kind]) for kind in ("across", "ground")),
        ),
        wall_dampers=taken.terms(dampers["wall"]),
        closing_dampers=taken.terms(dampers["closing"]),
        loads=taken.acting([(load.chain, load.bead, load.law) for load in system.loads]),
        motions=taken.acting([(each.chain, each.bead, law) for each in system.motions for law in each.laws]),
        moved=taken.places([(each.chain, each.bead) for each in system.motions]) if system.motions else "",
        inverse_mass="" if inverse is None else taken.add("inverse_mass", inverse),
        dashpots="none" if not system.dampers else "half step" if as_lammps else "kick" if cut else "drift",
        as_lammps=as_lammps,
        counts_work=physics.acted_on(system) and not as_lammps,
        bends="" if as_lammps or not len(bends) else taken.add("bends", bends),
        row=row,
        names=tuple(taken.names),
    )
    return terms, tuple(taken.values)


class _Parameters:
    """Collects the parameters of laws; gives terms that read them."""

    def __init__(self, system: System) -> None:
        self.names: list[str] = []
        self.values: list[Any] = []
        self._system = system
        self._lines = physics.lines(system)

    def add(self, label: str, value: Any) -> str:
        """Add a parameter; its name in programs."""
        self.names.append(f"{label}_{len(self.names)}")
        self.values.append(value)
        return self.names[-1]

    def gap_of(self, contacts: Links, first: int = 2) -> str:
        """Add the gaps of contacts, that of the first in a row; the source of that of the beads k and before."""
        if not isinstance(contacts.gap, np.ndarray):
            return self.add("gap", contacts.gap)
        return f"{self.add('gap', self._laid(contacts.gap, first))}[k]"

    def term(self, law: Any, strain: str, rate: str, *, first: int, state_at: str = "") -> Term:
        """A law on links of which that of the first bead is in row ``first``, and its state, if it has one, there."""
        parameters = []
        chains, state_name = self._system.chains, laws.state_name(law)
        for label, value in law.by_name.items():
            if label == state_name:
                parameters.append(f"{STATES}{state_at}")
                continue
            if self._lines > chains and label not in law.one_number:
                # of chains alone: without parameters a law exerts no force on further lines
                value = np.broadcast_to(value, (chains, self._system.beads + 1 - first))
            differs = np.ndim(value) > 0
            name = self.add(label, self._laid(value, first) if differs else float(value))
            parameters.append(f"{name}[k]" if differs else name)
        return Term(type(law), strain, rate, tuple(parameters), state_at=state_at if state_name else "")

    def terms(self, links: Sequence[Links]) -> tuple[Term, ...]:
        """Terms of links to the ground, or across."""
        terms: list[Term] = []
        for link in links:
            if link.kind == "across":
                terms += self._across(link)
            elif link.kind == "wall":
                side, gap = self.add("side", link.side), self.add("gap", link.gap)
                at = f"[k + {self.names[0]}]" if link.side > 0.0 else "[k]"
                end = self._system.beads if link.side > 0.0 else 1
                term = self.term(link.law, f"{side} * {{x}}[k] - {gap}", f"{side} * {{v}}[k]", first=end, state_at=at)
                terms.append(replace(term, sign=side, row=self.add("end", np.uint64(end)), place=(at,)))
            elif link.kind == "closing":
                terms.append(self._closing(link))
            else:
                term = self.term(link.law, "{x}[k]", "{v}[k]", first=1)
                terms.append(replace(term, time="time" * link.law.varies))
        return tuple(terms)

    def _closing(self, link: Links) -> Term:
        """Contact of the first bead with the last, which is behind it; its force is also that ahead of the last."""
        back = self.add("back", np.uint64((self._system.beads - 1) * self._lines))
        ahead, gap = f"[k + {back} + {self.names[0]}]", self.gap_of(link, 1)
        strain = f"{{x}}[k + {back}] - {{x}}[k] - {gap}", f"{{v}}[k + {back}] - {{v}}[k]"
        term = self.term(link.law, *strain, first=1, state_at=ahead)
        first = self.add("end", np.uint64(1))
        return replace(term, row=first, place=("[k]", ahead), behind=f"k + {back}")

    def acting(self, acting: Sequence[tuple[int, int, TimeLaw]]) -> tuple[Term, ...]:
        """Laws in time of beads (chain, bead); one term for those that follow each other and are of one kind."""
        terms = []
        for _, group in itertools.groupby(acting, lambda each: _shape(each[2])):
            alike = list(group)
            at = self.places([place for *place, _ in alike])
            law: Any = alike[0][2]
            values = zip(law.names, zip(*(each for *_, each in alike), strict=True), strict=True)
            parameters = tuple(f"{self.add(label, np.array(value))}[n]" for label, value in values)
            terms.append(Term(type(law), "", "", parameters, at))
        return tuple(terms)

    def places(self, beads: Iterable[Sequence[int]]) -> str:
        """Add the places of beads (chain, bead); its name in programs."""
        places = [bead * self._lines + chain - 1 for chain, bead in beads]
        return self.add("at", np.array(places, dtype=np.uint64))

    def _across(self, link: Links) -> list[Term]:
        law: Any = link.law
        distances, values = neighbours(link, self._system)
        shared = {label: self.add(label, float(getattr(law, label))) for label in law.one_number}
        arrays = [(label, value) for label, value in zip(law.names, values, strict=True) if label not in shared]
        if len(distances) > UNROLLED:
            apart = self.add("apart", distances)
            names = shared | {label: f"{self.add(label, value)}[m, k]" for label, value in arrays}
            sums = self.add("sums", np.zeros((3, values[0].shape[1])))
            return [Term(type(law), *_relative("apart"), tuple(names[label] for label in law.names), apart, sums)]
        terms = []
        for number, distance in enumerate(distances):
            apart = self.add("apart", distance)
            names = shared | {label: f"{self.add(label, value[number])}[k]" for label, value in arrays}
            terms.append(Term(type(law), *_relative(apart), tuple(names[label] for label in law.names)))
        return terms

    def _laid(self, parameter: Floats, first: int) -> Floats:
        """A parameter that differs, laid out as the state is, that of the first link in row ``first``."""
        rows = np.zeros((self._system.beads + 2, self._lines))
        rows[first : first + parameter.shape[1], : parameter.shape[0]] = parameter.T
        return rows.reshape(-1)


def _relative(apart: str) -> tuple[str, str]:
    """Strain and its rate of a spring to the bead at a distance in the arrays."""
    return f"{{x}}[k] - {{x}}[k + {apart}]", f"{{v}}[k] - {{v}}[k + {apart}]"


def _shape(law: TimeLaw) -> tuple[Any, ...]:
    """What laws in time must share to be one term: the class, and how many numbers each of its parameters has."""
    return type(law), tuple(map(np.shape, law))


def _inverse_mass(system: System, step: float) -> Floats | None:
    """One over the masses, 0 of beads whose motion is given; None where all are 1. With a step, as in LAMMPS."""
    mass = physics.masses(system, absent=np.inf)
    if step:
        more = sum(dashpot.resistance(link.law, 0.0) for link in system.dampers)
        mass = np.array(np.broadcast_to(mass, (physics.lines(system), system.beads)))
        mass[: system.chains] += 0.5 * step * more
    if isinstance(mass, float) and not system.motions:
        return None
    rows = np.ones((system.beads + 2, physics.lines(system)))
    rows[1:-1] /= np.transpose(mass)
    for motion in system.motions:
        rows[motion.bead, motion.chain - 1] = 0.0
    return rows.reshape(-1)


def neighbours(link: Links, system: System) -> tuple[NDArray[np.uint64], list[Floats]]:
    """Distances in the arrays to other beads of a row, those of lower chains first, and parameters, [distance, place].

    Where a chain has no other at that distance, the law's parameters are 0, which makes no force.
    """
    parameters: dict[int, list[Floats]] = {}
    for edge, (lower, higher) in enumerate(link.edges):
        values = [np.broadcast_to(value, system.beads) for value in laws.at(link.law, edge)]
        for line, neighbour in ((higher, lower), (lower, higher)):
            empty = [np.zeros((system.beads + 2, physics.lines(system))) for _ in values]
            for array, value in zip(parameters.setdefault(neighbour - line, empty), values, strict=True):
                array[1:-1, line] += value
    distances = np.array([distance % 2**64 for distance in sorted(parameters)], dtype=np.uint64)
    flat = ([array.reshape(-1) for array in parameters[distance]] for distance in sorted(parameters))
    return distances, [np.stack(arrays) for arrays in zip(*flat, strict=True)]
