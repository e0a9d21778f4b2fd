"""Action of the modes in which rows oscillate on springs that vary in time: energy over angular frequency.

An adiabatic invariant: each mode keeps its action where stiffnesses change slowly, and modes exchange it where their
frequencies come close (Landau and Zener; Novotny 2010). Rows are independent of each other while no contact is loaded.
"""

import numpy as np

from analysis import motion
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import System, laws, physics
from lammps_inputs.laws.spring import Linear
from lammps_inputs.laws.varying import Varying

MOST_CHAINS = 30
"""Whose modes are computed at every instant."""

UNLOADED = 1e-9
"""Share of the energy in contacts below which none counts as loaded."""


def has_modes(system: System) -> bool:
    """Whether rows have modes whose action can change: linear springs, the same in all rows, some of which vary."""
    springs = (*system.across, *physics.ground_springs(system))
    return (
        1 < system.chains <= MOST_CHAINS
        and physics.varying(system)
        and isinstance(system.mass, float)
        and system.inner_mass is None
        and not physics.loaded(system)
        and all(isinstance(link.law, Linear | Varying) for link in springs)
        and all(np.ndim(value) == 0 or np.ptp(value, axis=-1).max() == 0.0 for link in springs for value in link.law)
    )


def shares(block: Trajectory, frames: slice) -> Floats:
    """Share of the action that each mode has in some frames, slowest first, [frame, mode]; the system `has_modes`.

    NaN where a contact or wall is loaded, a mode has no restoring force, or nothing moves.
    """
    displacement, velocity = block.displacement[frames], block.velocity[frames]
    now = physics.at(block.problem.system, block.time[frames])
    square, shape = np.linalg.eigh(_stiffness(now, len(displacement)) / now.mass)
    x, v = (np.swapaxes(shape, -1, -2) @ part for part in (displacement, velocity))
    omega = np.sqrt(np.where(square[:, 0, None] > 0.0, square, np.nan))
    action = 0.5 * now.mass * np.sum(v * v + (square[..., None] * x) * x, axis=-1) / omega
    total = np.sum(action, axis=-1, keepdims=True)
    energy = motion.energy(now, displacement, velocity)
    loaded = sum(link.energy(displacement).sum(axis=(-2, -1)) for link in (*now.along, *physics.walls(now)))
    defined = (loaded <= UNLOADED * energy)[:, None] & (total > 0.0)
    return np.asarray(np.where(defined, action / np.where(defined, total, 1.0), np.nan))


def _stiffness(system: System, frames: int) -> Floats:
    """Of a row, [frame, chain, chain]."""
    found = np.zeros((frames, system.chains, system.chains))
    chains = np.arange(system.chains)
    for link in system.across:
        edges = link.of_edges(laws.stiffness(link.law, 0.0)).tolist()
        for (one, other), value in zip(link.edges, edges, strict=True):
            found[:, [one, other], [one, other]] += value
            found[:, [one, other], [other, one]] -= value
    for spring in physics.ground_springs(system):
        held = np.broadcast_to(laws.stiffness(spring.law, 0.0), (frames, system.chains, system.beads))
        found[:, chains, chains] += held[..., 0]
    return found
