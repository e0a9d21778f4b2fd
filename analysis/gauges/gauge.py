"""Places at which force is read: walls, contacts, and the inside of beads.

The force of a damped contact is all of it, that of its dashpot included, at the velocities that frames hold: those of
the moment of their positions. (LAMMPS itself takes the dashpot's at velocities of half a step before.)

Plug-ins take this module for forces: `gauges` chooses places of a system, `at_frames` reads their forces.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0, "walls": {"right": "bead"}}).problem()
    >>> frames = engine.run(problem)
    >>> chosen = gauge.gauges(problem.system, wall=True, contacts=(10,))
    >>> [each.name for each in chosen]
    ['right wall', 'contact 10']
    >>> gauge.at_frames(frames, chosen).max(axis=0).round(2)  # [chain, gauge] in m V / T
    array([[1.12, 0.64]])
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import System, laws, physics
from lammps_inputs.laws import dashpot

Kind = Literal["wall", "contact", "sensor"]

PULSE = 0.01
"""Share of its largest value, above the static one, from which a force is that of a pulse."""


@dataclass(frozen=True)
class Probe:
    """One contact, at the same place in every chain.

    Attributes:
        behind, ahead: beads whose difference of displacements is its strain, counted from 1; 0 for a body at rest.
        force: strain [chain, ...] -> elastic force [chain, ...], that at rest included: 0 where contacts are open,
            negative where contacts that act at a distance pull.
        static: [chain] force at rest.
        loss: strain, its rate -> force of the dashpot; None where there is none.
        place: that of its state in those of frames (`analysis.trajectory.Trajectory`); ``force`` takes the state.
    """

    behind: int
    ahead: int
    force: Callable[[Floats, Integers, Floats | None], Floats]
    static: Floats
    loss: Callable[[Floats, Floats, Integers], Floats] | None = None
    place: int = 0


@dataclass(frozen=True)
class Gauge:
    """A place at which force is read, in every chain: the mean of its contacts.

    Attributes:
        kind: what is read.
        name: for tables and figures.
        bead: number of the bead at the wall, of the one before the contact, or of the one with the sensor, from 1.
        probes: the contacts whose mean force is read.
    """

    kind: Kind
    name: str
    bead: int
    probes: tuple[Probe, ...]

    @property
    def static(self) -> Floats:
        """[chain] force at rest, in units of m V / T; 0 without a static load."""
        return np.asarray(sum(probe.static for probe in self.probes) / len(self.probes))

    @property
    def damped(self) -> bool:
        """Whether forces against velocities are among what is read, which jump where contacts close or open."""
        return any(probe.loss is not None for probe in self.probes)

    @property
    def side(self) -> str:
        """Side of a wall gauge: ``left`` or ``right``."""
        return "left" if self.bead == 1 else "right"


def gauges(
    system: System, *, wall: bool = False, contacts: tuple[int, ...] = (), sensors: tuple[int, ...] = ()
) -> tuple[Gauge, ...]:
    """Gauges at walls, between beads n and n + 1, and inside beads; from left to right by kind.

    Args:
        system: its walls and contacts.
        wall: whether each wall has one.
        contacts: number n of the bead before each contact, from 1.
        sensors: number of each bead with a gauge inside, between the first and the last bead.

    Returns:
        The gauges: at walls, in contacts, inside beads.
    """
    chosen = []
    for link in system.walls if wall else ():
        name, bead, place = ("right wall", system.beads, system.beads) if link.side > 0.0 else ("left wall", 1, 0)
        chosen.append(Gauge("wall", name, bead, (_probe(system, place),)))
    chosen += [Gauge("contact", f"contact {bead}", bead, (_probe(system, bead),)) for bead in contacts]
    chosen += [
        Gauge("sensor", f"sensor {bead}", bead, (_probe(system, _behind(system, bead)), _probe(system, bead)))
        for bead in sensors
    ]
    return tuple(chosen)


def far_wall(system: System) -> Gauge | None:
    """The gauge at the wall that the largest excitation goes towards; None where there is none."""
    side = "right" if physics.largest_excitation(system)[2] > 0.0 else "left"
    return next((gauge for gauge in gauges(system, wall=True) if gauge.side == side), None)


def _behind(system: System, bead: int) -> int:
    """Place of the contact behind a bead, from 0; of the first bead of a ring that with the last."""
    return system.beads if bead == 1 and system.closing else bead - 1


def _probe(system: System, place: int) -> Probe:
    """The contact at a place, from 0 before the first bead of every chain."""
    chains, beads = np.arange(system.chains), system.beads
    contacts = list(physics.at_place(system.links, place, beads))
    dashpots = list(physics.at_place(system.dampers, place, beads))

    def force(strain: Floats, chain: Integers, state: Floats | None) -> Floats:
        """Total force of the contact, of the strain's shape [chain, ...]."""
        laws_at = (
            (laws.at_state(laws.at(link.law, chain, position), state), link.gap_at(chain, position))
            for link, position in contacts
        )
        return np.asarray(sum(laws.force(law, strain - gap) + law.load for law, gap in laws_at))

    def loss(strain: Floats, rate: Floats, chain: Integers) -> Floats:
        """Force of the dashpot, of the strain's shape [chain, ...]; 0 where the contact is open."""
        (link, position), *_ = dashpots
        law: Any = laws.at(link.law, chain, position)
        strain = strain - link.gap_at(chain, position)
        return np.where(strain + law.rest > TOUCHING, dashpot.damping(law, strain, rate), 0.0)

    static = sum(
        np.broadcast_to(laws.at(link.law, chains, position).load, system.chains) for link, position in contacts
    )
    ahead = place + 1 if place < beads else 1 if system.closing else 0
    return Probe(place, ahead, force, np.asarray(static), loss if dashpots else None, place)


TOUCHING = 1e-12
"""Overlap, in units of L, from which on a dashpot acts: one that is rounding does not close a contact."""


def at_frames(block: Trajectory, gauges: tuple[Gauge, ...], *, dashpots: bool = True) -> Floats:
    """Forces of gauges at the frames of a run.

    Args:
        block: frames in which the beads of the gauges are recorded.
        gauges: places of the forces.
        dashpots: whether the force of dashpots is included.

    Returns:
        [frame, chain, gauge] in units of m V / T.
    """
    force = np.zeros((block.frames, block.problem.chains, len(gauges)))
    for place, gauge in enumerate(gauges):
        for probe in gauge.probes:
            strain, rate = strain_and_rate(block, probe)
            chain = np.broadcast_to(np.arange(block.problem.chains), strain.shape)
            reading = probe.force(strain, chain, block.states_of_contacts(probe.place))
            if dashpots and probe.loss is not None:
                reading = reading + probe.loss(strain, rate, chain)
            force[..., place] += reading / len(gauge.probes)
    return force


def strain_and_rate(block: Trajectory, probe: Probe) -> list[Floats]:
    """Strain of a contact and its rate at frames, [frame, chain] each, in units of L and L / T."""
    values = block.displacement, block.velocity
    return [_column(block, each, probe.behind) - _column(block, each, probe.ahead) for each in values]


def _column(block: Trajectory, values: Floats, bead: int) -> Floats:
    """Values of a bead, [frame, chain]; 0 for a body at rest."""
    if bead == 0:
        return np.zeros(values.shape[:2])
    return np.asarray(values[:, :, block.positions(bead)])
