"""Places at which force is read: walls, contacts, and the inside of beads."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, laws
from lammps_inputs.links import Wall

Integers = NDArray[np.int64]
Kind = Literal["wall", "contact", "sensor"]


@dataclass(frozen=True)
class Probe:
    """One contact, at the same place in every chain.

    Attributes:
        behind, ahead: beads whose difference of displacements is its strain, counted from 1; 0 for what is at rest.
        force: strain [chain, ...] -> force [chain, ...], never negative.
    """

    behind: int
    ahead: int
    force: Callable[[Floats, Integers], Floats]


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
    def side(self) -> str:
        """Of a wall: ``left`` or ``right``."""
        return "left" if self.bead == 1 else "right"


def gauges(problem: Problem, *, wall: bool, contacts: tuple[int, ...], sensors: tuple[int, ...]) -> tuple[Gauge, ...]:
    """Gauges at walls, between beads n and n + 1, and inside beads; from left to right by kind."""
    found = []
    if wall:
        for link in problem.walls:
            right = link.law.side > 0.0
            name = "right wall" if right else "left wall"
            found.append(Gauge("wall", name, problem.beads if right else 1, (_at_wall(problem, link),)))
    found += [Gauge("contact", f"contact {bead}", bead, (_between(problem, bead),)) for bead in contacts]
    found += [
        Gauge("sensor", f"sensor {bead}", bead, (_between(problem, bead - 1), _between(problem, bead)))
        for bead in sensors
    ]
    return tuple(found)


def _at_wall(problem: Problem, link: Wall) -> Probe:
    right = link.law.side > 0.0
    place = problem.beads - 1 if right else 0

    def force(strain: Floats, chain: Integers) -> Floats:
        displacement = strain if right else -strain
        return np.asarray(np.abs(laws.force(laws.at(link.law, chain, place), displacement)))

    return Probe(problem.beads, 0, force) if right else Probe(0, 1, force)


def _between(problem: Problem, bead: int) -> Probe:
    def force(strain: Floats, chain: Integers) -> Floats:
        return motion.contact_force(problem, strain - problem.gap, chain, np.full(chain.shape, bead - 1))

    return Probe(bead, bead + 1, force)
