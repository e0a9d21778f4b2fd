"""Linear modes about the static state: the generalised eigenvalue problem of stiffness and masses at rest."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain import InputError
from granchain.parts import Flags, Floats, Problem, System, dashpot, laws, motion, physics

MOST_FREE = 600
"""Atoms up to which periodic states and responses are computed, with dense matrices."""

ZERO = 1e-10
"""Squared frequency, over the largest, below which a mode has no stiffness: rounding leaves some 1e-14."""

ALIKE = 1e-8
"""Relative difference of frequencies below which two modes count as of one frequency."""

_EQUAL = 1e-6


@dataclass(frozen=True)
class LinearModes:
    """Modes of small oscillations about rest, by ascending frequency.

    Attributes:
        system: whose modes.
        frequency: [mode] angular, in 1 / T.
        shapes: [mode, line, bead] displacements, orthonormal with the masses as weights; 0 where there is no atom.
    """

    system: System
    frequency: Floats
    shapes: Floats

    @property
    def zeros(self) -> int:
        """Number of modes of frequency 0, which are the first."""
        return int(np.count_nonzero(self.frequency == 0.0))

    @property
    def energies(self) -> Floats:
        """Share of each atom in the energy of each mode, [mode, line, bead]: half of it is kinetic, on average."""
        return np.asarray(self.shapes**2 * mass_of_atoms(self.system))

    def vibrations(self) -> "LinearModes":
        """The modes of nonzero frequency."""
        return LinearModes(self.system, self.frequency[self.zeros :], self.shapes[self.zeros :])

    def alone(self, mode: int) -> bool:
        """Whether no other mode has the frequency of a mode, counted from 0, which is not 0."""
        others = np.delete(self.frequency, mode)
        frequency = self.frequency[mode]
        return bool(frequency > 0.0 and np.all(np.abs(others - frequency) > ALIKE * frequency))


def mass_of_atoms(system: System) -> Floats:
    """Masses of all atoms, [line, bead]; 0 where there is none."""
    return np.array(np.broadcast_to(physics.masses(system), (physics.lines(system), system.beads)))


def free_atoms(system: System) -> Flags:
    """Atoms that there are, [line, bead]."""
    return mass_of_atoms(system) > 0.0


def refuse_not_conservative(problem: Problem, source: str) -> None:
    """Refuse a scene whose energy changes after the start.

    Args:
        problem: of the scene.
        source: name of the scene in messages.

    Raises:
        InputError: says what changes its energy.
    """
    system = problem.system
    reasons = (
        (physics.contacts_with_state(system), "contacts that yield dissipate energy"),
        (
            system.motions or any(load.endless for load in system.loads),
            "a driven bead does work; `--frequencies LOW,HIGH` gives its responses; or leave `drive` out",
        ),
        (system.dampers, "damping dissipates energy; leave `damping` out"),
        (system.loads, "a push does work; leave `push` out, and kick a bead instead"),
        (system.weights, "weights of beads that fall do work; leave `settled: false` out"),
        (physics.varying(system), "a foundation that varies in time does work; give one number as its `stiffness`"),
    )
    for present, reason in reasons:
        if present:
            raise InputError(f"{source}: modes are those of a scene without driving and dissipation: {reason}")


def stiffness_matrix(system: System) -> Floats:
    """Stiffness of the links at rest, [atom, atom] of all places [line, bead] in order, in units of m / T^2."""
    return _matrix(system, system.links, laws.stiffness)


def damping_matrix(system: System) -> Floats:
    """Damping of the dashpots at rest, [atom, atom] of all places [line, bead] in order, in units of m / T."""
    return _matrix(system, system.dampers, dashpot.resistance)


def _matrix(system: System, links: Sequence[Any], slope_of: Callable[[Any, Floats], Any]) -> Floats:
    """Forces against displacements, or velocities, of one atom, from the slopes of laws at strains."""
    shape = physics.lines(system), system.beads
    units = np.eye(shape[0] * shape[1]).reshape(-1, *shape)
    forces, rest = np.zeros_like(units), np.zeros(shape)
    for link in links:
        lines = link.lines_among(system.chains)
        slope = slope_of(link.law, link.strain(rest[lines]))
        link.drive(forces[:, lines], slope * link.rate(units[:, lines]))
    return np.asarray(-forces.reshape(len(units), -1))


def linear_modes(problem: Problem, source: str) -> LinearModes:
    """All linear modes of a problem about rest.

    Args:
        problem: a conservative problem.
        source: name of the scene in messages.

    Raises:
        InputError: rest is unstable, or nothing has any stiffness there.
    """
    from scipy.linalg import eigh

    system = problem.system
    present, mass = free_atoms(system), mass_of_atoms(system)
    atoms = np.flatnonzero(present)
    matrix = stiffness_matrix(system)[np.ix_(atoms, atoms)]
    squares, vectors = eigh(0.5 * (matrix + matrix.T), np.diag(mass.ravel()[atoms]))
    largest = float(np.max(np.abs(squares)))
    if largest == 0.0:
        raise InputError(
            f"{source}: there are no linear modes: contacts that only touch have no stiffness at rest; a static load "
            "gives them one, such as `precompression: {force: 0.1}`"
        )
    if squares[0] < -ZERO * largest:
        raise InputError(
            f"{source}: the beads are not in a stable equilibrium at rest: a squared frequency is negative"
        )
    shapes = np.zeros((len(atoms), mass.size))
    shapes[:, atoms] = vectors.T
    # the largest displacement of a shape is positive, and of several that are equal within rounding the last
    sizes = np.abs(shapes)
    last = (
        shapes.shape[1] - 1 - np.argmax((sizes >= (1.0 - _EQUAL) * sizes.max(axis=1, keepdims=True))[:, ::-1], axis=1)
    )
    sign = np.sign(shapes[np.arange(len(shapes)), last])
    frequency = np.sqrt(np.where(squares > ZERO * largest, squares, 0.0))
    return LinearModes(system, frequency, (shapes * sign[:, np.newaxis]).reshape(-1, *mass.shape))


def free_to_drift(modes: LinearModes) -> bool:
    """Whether motion along the modes of frequency 0 meets no force at any amplitude, as that of chains as a whole."""
    drifts = modes.shapes[: modes.zeros]
    moved = np.concatenate([drifts, -drifts])
    forces = motion.acceleration(modes.system, moved)
    return bool(np.all(np.abs(forces) <= ZERO * modes.frequency.max() ** 2))


def centre(energies: Floats, system: System) -> tuple[float, float, float]:
    """Participation number, mean bead and mean chain, both counted from 1, of energies of atoms [line, bead].

    An atom of a further line counts as one of its bead's chain.
    """
    beads = energies.shape[1]
    weights = energies / np.sum(energies)
    chain = system.chain_of_line + 1.0
    return (
        motion.participation(energies),
        float(np.sum(weights * np.arange(1, beads + 1))),
        float(np.sum(weights * chain[:, np.newaxis])),
    )
