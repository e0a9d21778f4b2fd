"""The equation of motion on recorded states: acceleration and its rate, energy and momentum, each a sum over links.

All dimensionless. Which links there are, and their laws, is the problem's (`lammps_inputs.links`). Arrays are
[..., chain, bead] of consecutive beads, which begin with bead ``first``.
"""

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats, Trajectory
from lammps_inputs import System, laws
from lammps_inputs.links import Across

Integers = NDArray[np.int64]


def overlaps(system: System, displacement: Floats) -> Floats:
    """Overlap of each bead with the next of its chain, [..., chain, bead - 1]; negative where they are apart."""
    return system.along[0].strain(displacement)


def energy(system: System, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
    """Total energy of states, [...] from [..., chain, bead]: kinetic, and of every link (eq. 1 integrated)."""
    total = 0.5 * np.sum(velocity * velocity, axis=(-2, -1))
    for link in system.links:
        total += np.sum(link.energy(displacement, first), axis=(-2, -1))
    return np.asarray(total)


def chain_energy(system: System, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
    """Energy of each chain, [..., chain] from [..., chain, bead]; that of a spring is shared by its two chains."""
    total = np.asarray(np.sum(0.5 * velocity * velocity, axis=-1))
    for link in system.links:
        link.add_chain_energy(total, link.energy(displacement, first))
    return total


def bead_energy(system: System, displacement: Floats, velocity: Floats, first: int = 1) -> Floats:
    """Energy of each bead in its own chain, [..., chain, bead] from the same.

    Two beads in contact have half of its energy each. What the springs between chains hold is nobody's.
    """
    total = np.asarray(0.5 * velocity * velocity)
    for link in (*system.along, *system.ground):
        link.shared(total, link.energy(displacement, first))
    return total


def contact_energy(system: System, displacement: Floats, first: int = 1) -> Floats:
    """Energy in each contact, [..., chain, bead - 1]."""
    return np.asarray(sum(link.energy(displacement, first) for link in system.along))


def stored_in_contact(system: System, overlap: Floats, *contact: Integers | slice) -> Floats:
    """Energy in chosen contacts at an overlap; see `contact_force`."""
    return np.asarray(sum(laws.energy(laws.at(link.law, *contact), overlap) for link in system.along))


def contact_force(system: System, overlap: Floats, *contact: Integers | slice) -> Floats:
    """Force of chosen contacts at an overlap; they are [chain, contact] positions of the links, from 0."""
    return np.asarray(sum(laws.force(laws.at(link.law, *contact), overlap) for link in system.along))


def contact_stiffness(system: System, overlap: Floats, *contact: Integers | slice) -> Floats:
    """Slope of `contact_force`."""
    return np.asarray(sum(laws.stiffness(laws.at(link.law, *contact), overlap) for link in system.along))


def momentum(velocity: Floats) -> Floats:
    """Total momentum along the chains, [...] from [..., chain, bead]."""
    return np.asarray(np.sum(velocity, axis=(-2, -1)))


def acceleration(system: System, displacement: Floats, first: int = 1, *, time: Floats | None = None) -> Floats:
    """Acceleration of every bead, [..., chain, bead] from the same; every bead must be recorded (eq. 1).

    Forces from outside are left out where no times, [...], are given.
    """
    result = np.zeros_like(displacement)
    for link in system.links:
        link.drive(result, link.force(displacement, first))
    for load in system.loads if time is not None else ():
        result[..., load.chain - 1, load.bead - first] += load.force(time)
    return result


def acceleration_and_rate(block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> tuple[Floats, Floats]:
    """Second and third derivative of displacement at chosen (frame, chain, bead) positions of a block.

    Every bead must be recorded. Indices count from 0 and have one shape, which both results have.
    """
    problem, x, v = block.problem, block.displacement, block.velocity
    here_x, here_v = x[frame, chain, bead], v[frame, chain, bead]
    acceleration, rate = np.zeros_like(here_x), np.zeros_like(here_x)

    def pulled_back(law: laws.Law, sign: int, strain: Floats, strain_rate: Floats, there: NDArray[np.bool_]) -> None:
        nonlocal acceleration, rate
        acceleration -= np.where(there, sign * laws.force(law, strain), 0.0)
        rate -= np.where(there, sign * laws.stiffness(law, strain) * strain_rate, 0.0)

    row = block.first - 1 + bead
    for side in (-1, 1):
        for contact in problem.along:
            other = bead + side
            there = (other >= 0) & (other < x.shape[2])
            other = np.where(there, other, bead)
            law = laws.at(contact.law, chain, np.clip(np.minimum(row, row + side), 0, problem.beads - 2))
            strain = side * (here_x - x[frame, chain, other]) - contact.gap
            pulled_back(law, side, strain, side * (here_v - v[frame, chain, other]), there)
        for spring in problem.across:
            for edge, partner in partners(spring, problem.chains, side, chain):
                law = laws.at(spring.law, edge, row)
                apart, parting = here_x - x[frame, partner, bead], here_v - v[frame, partner, bead]
                pulled_back(law, 1, apart, parting, partner != chain)
    for ground in problem.ground:
        pulled_back(laws.at(ground.law, chain, row), 1, here_x, here_v, np.ones(frame.shape, dtype=bool))
    for load in problem.loads:
        here, time = (chain == load.chain - 1) & (row == load.bead - 1), block.time[frame]
        acceleration += np.where(here, load.force(time), 0.0)
        rate += np.where(here, load.rate(time), 0.0)
    return acceleration, rate


def partners(link: Across, chains: int, side: int, chain: Integers) -> list[tuple[Integers, Integers]]:
    """Edges of chosen chains, and the chains at their other ends: of lower (side -1) or higher number.

    As many pairs as any chain has; where a chain has fewer, its partner is itself.
    """
    table = link.partners(chains, side)[chain]
    ends = np.array(link.edges)[:, 0 if side < 0 else 1]
    return [(edge, np.where(edge >= 0, ends[edge], chain)) for edge in np.moveaxis(table, -1, 0)]


def larger_overlap(block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> Floats:
    """The larger of a bead's two overlaps at chosen (frame, chain, bead) positions of a block, negative if apart.

    Indices count from 0 and have one shape, which the result has; NaN where not all beads are recorded.
    """
    result = np.full(frame.shape, np.nan)
    if block.problem.recorded is None:
        x = block.displacement
        for side in (-1, 1):
            other = np.clip(bead + side, 0, x.shape[2] - 1)
            overlap = side * (x[frame, chain, bead] - x[frame, chain, other]) - block.problem.gap
            result = np.fmax(result, np.where(other == bead, -np.inf, overlap))
    return result
