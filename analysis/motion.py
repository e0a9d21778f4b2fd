"""The equation of motion on recorded states: acceleration and its rate, energy and momentum.

All dimensionless (mass 1, contact force ``overlap**1.5``); see `lammps_inputs.contact` and `lammps_inputs.coupling`.
"""

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, contact, coupling

Integers = NDArray[np.int64]


def overlaps(displacement: Floats, gap: float) -> Floats:
    """Overlap of each bead with the next of its chain, [..., chain, bead - 1]; negative where they are apart."""
    return displacement[..., :-1] - displacement[..., 1:] - gap


def energy(problem: Problem, displacement: Floats, velocity: Floats) -> Floats:
    """Total energy of states in which every bead is recorded, [...] from [..., chain, bead].

    Sum of ``v**2 / 2``, of ``2/5 overlap**2.5`` over contacts and of ``kappa / 2 * relative displacement**2`` over
    springs (eq. 1 of the paper integrated).
    """
    total = 0.5 * np.sum(velocity * velocity, axis=(-2, -1))
    total += np.sum(contact.energy(overlaps(displacement, problem.gap)), axis=(-2, -1))
    if problem.coupled:
        relative = np.diff(displacement, axis=-2)
        total += np.sum(coupling.energy(relative, problem.kappa), axis=(-2, -1))
    return np.asarray(total)


def momentum(velocity: Floats) -> Floats:
    """Total momentum along the chains, [...] from [..., chain, bead]."""
    return np.asarray(np.sum(velocity, axis=(-2, -1)))


def acceleration(problem: Problem, displacement: Floats) -> Floats:
    """Acceleration of every bead, [..., chain, bead] from the same; every bead must be recorded (eq. 1)."""
    push = contact.force(overlaps(displacement, problem.gap))
    result = np.zeros_like(displacement)
    result[..., 1:] += push
    result[..., :-1] -= push
    if problem.coupled:
        pull = problem.kappa * np.diff(displacement, axis=-2)
        result[..., :-1, :] += pull
        result[..., 1:, :] -= pull
    return result


def acceleration_and_rate(block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> tuple[Floats, Floats]:
    """Second and third derivative of displacement at chosen (frame, chain, bead) positions of a block.

    Every bead must be recorded. Indices count from 0 and have one shape, which both results have.
    """
    problem, x, v = block.problem, block.displacement, block.velocity
    here_x, here_v = x[frame, chain, bead], v[frame, chain, bead]
    acceleration, rate = np.zeros_like(here_x), np.zeros_like(here_x)
    for side in (-1, 1):
        other = bead + side
        there = (other >= 0) & (other < x.shape[2])
        other = np.where(there, other, bead)
        overlap = side * (here_x - x[frame, chain, other]) - problem.gap
        closing = side * (here_v - v[frame, chain, other])
        acceleration -= np.where(there, side * contact.force(overlap), 0.0)
        rate -= np.where(there, side * contact.stiffness(overlap) * closing, 0.0)
        if problem.coupled:
            other = np.clip(chain + side, 0, problem.chains - 1)
            acceleration += problem.kappa * (x[frame, other, bead] - here_x)
            rate += problem.kappa * (v[frame, other, bead] - here_v)
    return acceleration, rate


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
