"""Momentum equations of a trajectory: impulses of every kind of force between two frames, from the recorded motion.

The motion between two frames is taken as the cubic polynomial through displacements and velocities of both. Arrays are
[interval, line, bead]: intervals between two frames, lines of atoms (the chains, then further lines), beads of a line.
Impulses are in units of m V. Every atom must be recorded, and every force follow from the state.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis import hermite
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import System, laws, physics
from lammps_inputs.laws import dashpot
from lammps_inputs.laws.contact import pressed
from lammps_inputs.laws.dashpot import ContactDashpot, Dashpot
from lammps_inputs.laws.spring import Linear
from lammps_inputs.links import Links
from lammps_inputs.loads import Load

STATIC = "static load of the contacts"
"""Name of the term of the load in the contacts at rest."""

HOLDING = "forces that hold the beads at rest (on the ends, or weights)"
"""Name of the term of the static forces from outside."""

MOST_KINDS = 8
"""Kinds of beads, or of contacts, that have a factor each."""

_NODES = 4
"""Points of Gauss's rule between two frames."""

_STEP = 0.01
"""Difference of two static loads, over that of the scene, from which the derivative by the load is computed."""

ForceOfState = Callable[[Floats, Floats, Floats], Floats]
"""Force of links, [interval, ...], at times [interval], displacements and velocities [interval, line, bead]."""


@dataclass(frozen=True, eq=False)
class MomentumTerm:
    """One unknown factor of the momentum equations.

    Attributes:
        name: of the force or the beads, such as "coupling".
        column: [interval, line, bead] what a factor larger by 1 adds to the right-hand side.
        scene: factor of the scene: 1, or 0 of a force that the scene lacks.
        mass: whether it is the mass of beads, which stands on the left-hand side.
    """

    name: str
    column: Floats
    scene: float = 1.0
    mass: bool = False


@dataclass(frozen=True, eq=False)
class LinkImpulses:
    """Links of one law and their impulses, [interval, ...] as the forces of links; ``scene``: see `MomentumTerm`."""

    name: str
    link: Links
    impulse: Floats
    scene: float = 1.0


def integrals(trajectory: Trajectory, forces: Sequence[ForceOfState]) -> list[Floats]:
    """Integrals of forces from each frame to the next, each [interval, ...]."""
    (x, v), spacing = trajectory.atoms, np.diff(trajectory.time)
    h = spacing[:, np.newaxis, np.newaxis]
    polynomial = hermite.coefficients((0, 1), np.array([[x[:-1], h * v[:-1]], [x[1:], h * v[1:]]]), 1.0)
    rate = hermite.derivative(polynomial)
    totals: list[Any] = [0.0] * len(forces)
    for node, weight in zip(*np.polynomial.legendre.leggauss(_NODES), strict=True):
        s = np.full(x[1:].shape, 0.5 * (1.0 + node))
        state = trajectory.time[:-1] + s[:, 0, 0] * spacing, hermite.value(polynomial, s), hermite.value(rate, s) / h
        totals = [total + 0.5 * weight * h * force(*state) for total, force in zip(totals, forces, strict=True)]
    return totals


class MomentumEquations:
    """Change of momentum of every atom from each frame to the next, and the terms that it is the sum of.

    Attributes:
        load: static load of the contacts, over that of the scene, with which impulses are computed.
        change: changes of momentum, [interval, line, bead], at the masses of the scene; 0 where beads are driven.
        links: all links and dashpots, and those that the scene lacks, with their impulses.
        terms: all unknown factors.
        residual: what the forces of the scene leave of the change, [interval, line, bead].
    """

    def __init__(self, trajectory: Trajectory, load: float = 1.0) -> None:
        """Compute the impulses of all forces."""
        self.trajectory, self.system, self.load = trajectory, trajectory.problem.system, load
        self.change = self._but_for_driven(np.diff(trajectory.atoms[1], axis=0) * physics.masses(self.system))
        self.links = self._link_impulses()
        forces = [*self._of_links(), *self._of_loads()]
        self.residual = self.change - sum(term.scene * term.column for term in forces)
        self.terms = [*forces, *self._of_static_load(), *self._of_masses()]

    def scene_links(self) -> list[LinkImpulses]:
        """Links and dashpots of the scene with their impulses, but for what changes in time."""
        return [part for part in self.links if part.scene and part.name == part.link.name]

    def lines(self, link: Links) -> slice:
        """Lines of the atoms that links are among."""
        return link.lines_among(self.system.chains)

    def column(self, link: Links, impulse: Floats) -> Floats:
        """Change of momentum of all atoms, [interval, line, bead], by impulses of links, [interval, ...]."""
        total = np.zeros_like(self.change)
        link.drive(total[:, self.lines(link)], impulse)
        return self._but_for_driven(total)

    def force(self, link: Links) -> ForceOfState:
        """Force of links or dashpots as a function of time and state."""
        lines = self.lines(link)
        if link.law.damping is not None:
            return lambda _, x, v: link.damping(x[:, lines], v[:, lines])
        return lambda time, x, _: link.at(time).force(x[:, lines])

    def _but_for_driven(self, values: Floats) -> Floats:
        """Values [interval, line, bead] with 0, in place, at beads of prescribed motion, whose forces are unknown."""
        for motion in self.system.motions:
            values[..., motion.chain - 1, motion.bead - 1] = 0.0
        return values

    def _link_impulses(self) -> list[LinkImpulses]:
        """Impulses of all links; of those that depend on time, of what does not and of what does apart."""
        x, system = self.trajectory.atoms[0], self.system
        elastic = [_under(link, self.load) for link in system.links]
        varying = [link for link in elastic if link.law.varies]
        steady = {link: replace(link, law=link.law.steady) for link in varying}
        missing = list(_missing(system))
        every = [*elastic, *steady.values(), *system.dampers, *missing]
        exact = [link for link in every if link.law.impulse is not None and not dashpot.cut(link.law)]
        others = [link for link in every if link not in exact]
        impulses = dict(zip(others, integrals(self.trajectory, list(map(self.force, others))), strict=True))
        impulses |= {link: np.diff(link.given(x[:, self.lines(link)]), axis=0) for link in exact}
        result = []
        for link in (*elastic, *system.dampers):
            constant = impulses[steady.get(link, link)]
            result.append(LinkImpulses(link.name, link, constant))
            if link in steady:
                result.append(LinkImpulses(f"change of the {link.name} in time", link, impulses[link] - constant))
        return result + [LinkImpulses(link.name, link, impulses[link], scene=0.0) for link in missing]

    def _of_links(self) -> Iterator[MomentumTerm]:
        """Factors of all links; of contacts of some kinds one for each kind."""
        for part in self.links:
            strength = laws.strength(part.link.law)
            kinds = np.unique(strength) if part.name == self.system.along[0].name else np.ones(1)
            if not 1 < len(kinds) <= MOST_KINDS:
                yield MomentumTerm(part.name, self.column(part.link, part.impulse), part.scene)
                continue
            for kind in kinds.tolist():
                impulse = part.impulse * (strength == kind)
                yield MomentumTerm(f"{part.name} of strength {kind:.4g}", self.column(part.link, impulse))

    def _of_loads(self) -> Iterator[MomentumTerm]:
        """Factors of pushes and of drives by a force."""
        for load in self.system.loads:
            column = np.zeros_like(self.change)
            column[:, load.chain - 1, load.bead - 1] = np.diff(load.impulse(self.trajectory.time))
            yield MomentumTerm(name_of_load(load), self._but_for_driven(column))

    def _of_static_load(self) -> Iterator[MomentumTerm]:
        """Static forces from outside, and the static load in the contacts, in which the equations are not linear."""
        bearing = [link for link in self.system.links if np.any(link.law.load)]
        if not bearing:
            return
        outside = np.zeros_like(self.change)
        for link in bearing:
            load = np.broadcast_to(link.law.load, link.strain(self.trajectory.displacement[1:]).shape)
            link.drive(outside[:, : self.system.chains], -load)
        spacing = np.diff(self.trajectory.time)[:, np.newaxis, np.newaxis]
        yield MomentumTerm(HOLDING, self._but_for_driven(outside * spacing))
        if physics.exponent(self.system) is not None:
            links = [_under(link, self.load + _STEP) for link in bearing]
            more = integrals(self.trajectory, list(map(self.force, links)))
            less = {part.name: part.impulse for part in self.links}
            columns = [self.column(link, (i - less[link.name]) / _STEP) for link, i in zip(links, more, strict=True)]
            yield MomentumTerm(STATIC, np.sum(columns, axis=0), scene=self.load)

    def _of_masses(self) -> Iterator[MomentumTerm]:
        """Factors of the masses of kinds of beads, but of the most frequent one, and of tied atoms."""
        mass = np.broadcast_to(self.system.mass, (self.system.chains, self.system.beads))
        kinds = np.unique(mass)
        groups = {} if len(kinds) > MOST_KINDS else {name_of_beads(kind): mass == kind for kind in kinds.tolist()}
        groups.pop(name_of_beads(self.usual_mass), None)
        for name, beads in groups.items():
            column = np.zeros_like(self.change)
            column[:, : self.system.chains] = np.where(beads, -self.change[:, : self.system.chains], 0.0)
            yield MomentumTerm(name, column, mass=True)
        for link in self.system.ties:
            column, tied = np.zeros_like(self.change), sorted({higher for _, higher in link.edges})
            column[:, tied] = -self.change[:, tied]
            yield MomentumTerm(link.name, column, mass=True)

    @property
    def size(self) -> float:
        """Norm of all changes of momentum; 1 if nothing moves."""
        return float(np.linalg.norm(self.change)) or 1.0

    @property
    def usual_mass(self) -> float:
        """Mass of most beads."""
        kinds, counts = np.unique(self.system.mass, return_counts=True)
        return float(kinds[np.argmax(counts)])


def name_of_load(load: Load) -> str:
    """Name of a force from outside, such as "push on bead 1 of chain 2"."""
    return f"{'drive' if load.endless else 'push'} on bead {load.bead} of chain {load.chain}"


def name_of_beads(mass: float) -> str:
    """Name of the beads of a mass."""
    return f"beads of mass {mass:.3g}"


def _under(link: Links, load: float) -> Links:
    """Links with their static load multiplied by a factor."""
    return link if load == 1.0 or not np.any(link.law.load) else replace(link, law=pressed(link.law, load))


def _missing(system: System) -> Iterator[Links]:
    """Springs between the chains and to the ground, and dashpots, linear and of coefficient 1, that a system lacks."""
    if system.chains > 1 and not system.couplings:
        yield Links.across("coupling", Linear(1.0), tuple((j, j + 1) for j in range(system.chains - 1)))
    if not system.ground:
        yield Links.ground("foundation", Linear(1.0))
    if physics.contact_loss(system) is None:
        contacts = system.along[0]
        dashpot_law = ContactDashpot(1.0, rest=contacts.law.rest)
        yield Links.along("contact_damping", dashpot_law, contacts.gap)
    if all(link.kind != "ground" for link in system.dampers):
        yield Links.ground("bead_damping", Dashpot(1.0))
