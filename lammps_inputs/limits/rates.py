"""How fast anything in a system can move: bounds on angular frequencies, rates and speeds, dimensionless.

By Gershgorin's circles, with every contact and spring as stiff as the energy of the system can make it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws, physics
from lammps_inputs.laws import dashpot
from lammps_inputs.laws.in_time import Sine
from lammps_inputs.links import Across, Along, WallDamper, largest_eigenvalue
from lammps_inputs.system import System


def fastest(system: System) -> float:
    """Angular frequency, at most, of any motion; energy bounds how stiff a contact can get."""
    endless = (load.law.omega for load in system.loads if isinstance(load.law, Sine))
    own = float(np.sqrt(_contacts(system) + _springs(system)))
    return max((own, *endless, *(motion.omega for motion in system.motions)))


def of_contacts(system: System) -> float:
    """Angular frequency, at most, of beads on their contacts, springs left out."""
    return float(np.sqrt(_contacts(system)))


def swing(system: System) -> float:
    """Angular frequency, at most, of a bead on its springs, those across and those to the ground, and of sound."""
    return float(np.sqrt(_springs(system) + sound_frequency(system) ** 2))


def sound_frequency(system: System) -> float:
    """Angular frequency, at most, of sound: small motions about rest, springs left out; 0 where there is none."""
    if not physics.loaded(system):
        return 0.0
    total = sum(_on_beads(system, laws.stiffness(link.law, 0.0)) for link in system.along)
    for wall in physics.walls(system):
        total += laws.stiffness(wall.law, 0.0)
    return float(np.sqrt(np.max(total / system.mass)))


def pace(system: System) -> float:
    """Beads that a pulse passes in a unit of time, at most.

    As fast as sound at the largest force, if any bead is lighter, or any contact under load or harder, than the
    reference's.
    """
    plain = (
        physics.alike(system)
        and not physics.loaded(system)
        and all(laws.strength(link.law) == 1.0 for link in system.along)
    )
    return 1.0 if plain else max(1.0, 0.5 * float(np.sqrt(_contacts(system))))


def drag(system: System) -> float:
    """Rate, at most, at which dashpots stop any motion."""
    contacts, others = np.zeros(1), 0.0
    for link in system.dampers:
        if isinstance(link, Along):
            reached = dashpot.at_reach(link.law, system.along[0].law, physics.energy(system))
            contacts = contacts + _on_beads(system, reached)
        elif isinstance(link, WallDamper):
            contacts = contacts + dashpot.at_reach(
                link.law, physics.wall_at(system, link.law.side).law, physics.energy(system)
            )
        else:
            graph = largest_eigenvalue(link, system.chains) if isinstance(link, Across) else 1.0
            others += graph * float(np.max(dashpot.resistance(link.law, 0.0)))
    return float(np.max(contacts / system.mass)) + others / float(np.min(system.mass))


def _contacts(system: System) -> float:
    if physics.alike(system):
        wall = max((laws.stiffest(link.law, physics.energy(system)) for link in physics.walls(system)), default=0.0)
        contacts = sum(4.0 * laws.stiffest(link.law, physics.energy(system)) for link in system.along)
        # a bead at the end has one contact, and a wall
        return max(contacts, 0.5 * contacts + wall) if physics.walls(system) else contacts
    total = sum(_on_beads(system, laws.stiffest_of_each(link.law, physics.energy(system))) for link in system.along)
    for held in physics.walls(system):
        total += laws.stiffest_of_each(held.law, physics.energy(system))
    return float(np.max(total / system.mass))


def _on_beads(system: System, contact: Any) -> NDArray[np.float64]:
    """Bound on what the contacts do to each bead's motion, [chain, bead]: twice the sum of both."""
    total = np.zeros((system.chains, system.beads))
    for side in (slice(1, None), slice(None, -1)):
        total[:, side] += 2.0 * np.broadcast_to(contact, (system.chains, system.beads - 1))
    return total


def _springs(system: System) -> float:
    across = (_row(system, link) for link in system.across)
    held = (laws.stiffest(link.law, physics.energy(system)) for link in physics.ground_springs(system))
    return sum((*across, *held), 0.0) / float(np.min(system.mass)) + _inner(system)


def _inner(system: System) -> float:
    """Bound on what links to inner atoms do to each atom's motion: twice the sum of all at it."""
    if system.inner_mass is None:
        return 0.0
    total = np.zeros((physics.lines(system), system.beads))
    for link in system.inner_links:
        stiffest = laws.stiffest_of_each(link.law, physics.energy(system))
        for ends, of_edge in zip(link.edges, np.broadcast_to(stiffest, (len(link.edges), system.beads)), strict=True):
            total[list(ends)] += 2.0 * of_edge
    return float(np.max(total / physics.mass_of_atoms(system)))


def _row(system: System, link: Across) -> float:
    """Largest eigenvalue of a row of beads on links across, each as stiff as energy can make it anywhere."""
    if not laws.differs(link.law):
        return laws.stiffest(link.law, physics.energy(system)) * largest_eigenvalue(link, system.chains)
    return largest_eigenvalue(
        link, system.chains, link.of_edges(laws.stiffest_of_each(link.law, physics.energy(system)))
    )
