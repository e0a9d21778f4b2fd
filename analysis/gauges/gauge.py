"""Places at which force is read: walls, contacts, and the inside of beads.

The force of a damped contact is all of it, that of its dashpot included, at the velocities that frames hold: those of
the moment of their positions. (LAMMPS itself takes the dashpot's at velocities of half a step before.)
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from analysis import motion
from analysis.trajectory import Floats, Integers
from lammps_inputs import System, laws, physics
from lammps_inputs.laws import dashpot
from lammps_inputs.links import Wall

Kind = Literal["wall", "contact", "sensor"]


@dataclass(frozen=True)
class Probe:
    """One contact, at the same place in every chain.

    Attributes:
        behind, ahead: beads whose difference of displacements is its strain, counted from 1; 0 for what is at rest.
        force: strain [chain, ...] -> elastic force [chain, ...], that at rest included, never negative; 0 where the
            contact is open.
        static: [chain] at rest.
        loss: strain, its rate -> force of the dashpot; None where there is none.
    """

    behind: int
    ahead: int
    force: Callable[[Floats, Integers], Floats]
    static: Floats
    loss: Callable[[Floats, Floats, Integers], Floats] | None = None


@dataclass(frozen=True)
class Gauge:
    """A place at which force is read, in every chain: the mean of its contacts.

    Attributes:
        kind: what is read.
        name: for tables and figures.
        bead: the first or last one, at a wall; the first of a contact; the one with the sensor.
    """

    kind: Kind
    name: str
    bead: int
    probes: tuple[Probe, ...]

    @property
    def static(self) -> Floats:
        """[chain] at rest; 0 without a static load."""
        return np.asarray(sum(probe.static for probe in self.probes) / len(self.probes))

    @property
    def damped(self) -> bool:
        """Whether forces against velocities are among what is read, so that it may be negative."""
        return any(probe.loss is not None for probe in self.probes)

    @property
    def side(self) -> str:
        """Of a wall: ``left`` or ``right``."""
        return "left" if self.bead == 1 else "right"


def gauges(problem: System, *, wall: bool, contacts: tuple[int, ...], sensors: tuple[int, ...]) -> tuple[Gauge, ...]:
    """Gauges at walls, between beads n and n + 1, and inside beads; from left to right by kind."""
    found = []
    if wall:
        for link in physics.walls(problem):
            right = link.law.side > 0.0
            name = "right wall" if right else "left wall"
            found.append(Gauge("wall", name, problem.beads if right else 1, (_at_wall(problem, link),)))
    found += [Gauge("contact", f"contact {bead}", bead, (_between(problem, bead),)) for bead in contacts]
    found += [
        Gauge("sensor", f"sensor {bead}", bead, (_between(problem, bead - 1), _between(problem, bead)))
        for bead in sensors
    ]
    return tuple(found)


def far_wall(system: System) -> Gauge | None:
    """The gauge at the wall that the largest excitation goes towards; None where there is none."""
    side = "right" if physics.largest_excitation(system)[2] > 0.0 else "left"
    return next((gauge for gauge in gauges(system, wall=True, contacts=(), sensors=()) if gauge.side == side), None)


def _at_wall(problem: System, link: Wall) -> Probe:
    right = link.law.side > 0.0
    place = problem.beads - 1 if right else 0

    def force(strain: Floats, chain: Integers) -> Floats:
        law = laws.at(link.law, chain, place)
        displacement = strain if right else -strain
        return np.asarray(np.maximum(link.law.side * laws.force(law, displacement) + laws.load(law), 0.0))

    damper = physics.wall_loss(problem, link.law.side)

    def loss(strain: Floats, rate: Floats, chain: Integers) -> Floats:
        law = laws.at(damper, chain, place)  # type: ignore[arg-type]
        return np.asarray(link.law.side * dashpot.damping(law, link.law.side * strain, link.law.side * rate))

    chain = np.arange(problem.chains)
    static = np.broadcast_to(laws.load(laws.at(link.law, chain, place)), problem.chains)
    behind, ahead = (problem.beads, 0) if right else (0, 1)
    return Probe(behind, ahead, force, static, None if damper is None else loss)


def _between(problem: System, bead: int) -> Probe:
    def force(strain: Floats, chain: Integers) -> Floats:
        contact = np.full(chain.shape, bead - 1)
        overlap = strain - physics.gap(problem) + motion.rest_overlap(problem, chain, contact)
        return motion.contact_force(problem, overlap, chain, contact)

    at_rest = (laws.load(laws.at(link.law, Ellipsis, bead - 1)) for link in problem.along)
    static = np.broadcast_to(sum(at_rest), problem.chains)
    return Probe(bead, bead + 1, force, static, None if physics.contact_loss(problem) is None else _loss(problem, bead))


def _loss(problem: System, bead: int) -> Callable[[Floats, Floats, Integers], Floats]:
    def loss(strain: Floats, rate: Floats, chain: Integers) -> Floats:
        law = laws.at(physics.contact_loss(problem), chain, bead - 1)  # type: ignore[arg-type]
        return np.asarray(dashpot.damping(law, strain - physics.gap(problem), rate))

    return loss
