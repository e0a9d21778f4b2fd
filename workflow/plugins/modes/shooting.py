"""Periodic states of a conservative system, by shooting over half a period, and branches of them.

A state at rest, v(0) = 0, whose beads are all at rest again at T / 2 returns to its start at T, since forces do not
depend on velocity: the second half of the motion is the first in reverse. The unknowns are displacements x(0) and the
period T. The Jacobian is the tangent flow's, the derivative of the computed map; that with respect to the period is the
acceleration at T / 2, which differs from the computed map's by the error of the scheme.

Displacements are those of the linear modes of nonzero frequency omega: ``y = omega q``, with the modal coordinates q,
so that the energy is half of ``|y|^2`` near rest. Chains that are free to drift do so with none of these coordinates.
"""

import math
from dataclasses import dataclass

import numpy as np

from granchain.parts import Floats, Problem, motion
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes.continuation import (
    NO_CONVERGENCE,
    Branch,
    Condition,
    Continuable,
    Corrected,
    Direction,
    PeriodicState,
    between,
    continued,
)
from workflow.plugins.modes.linear import LinearModes, mass_of_atoms

START = 1e-4
"""Energy of the first state of a branch, over the largest."""

SAMPLES = 32
"""Times in half a period at which the motion is sampled; the number of steps is a multiple of it."""


@dataclass(frozen=True)
class Shooting(Continuable):
    """Shooting in the coordinates of modes.

    Attributes:
        problem: what is integrated.
        modes: its modes of nonzero frequency.
        steps: steps of the reference in half a period.
    """

    problem: Problem
    modes: LinearModes
    steps: int

    def displacement(self, y: Floats) -> Floats:
        """Displacements [..., line, bead] in units of L of coordinates [..., mode]."""
        return np.asarray(np.tensordot(y / self.modes.frequency, self.modes.shapes, axes=1))

    def momenta(self, rates: Floats) -> Floats:
        """Coordinates [..., mode] of velocities, or of accelerations, [..., line, bead]."""
        weighted = rates * mass_of_atoms(self.problem.system)
        return np.asarray(np.tensordot(weighted, self.modes.shapes, axes=([-2, -1], [1, 2])))

    def force(self, y: Floats) -> Floats:
        """Rates of the momenta, [mode], at coordinates."""
        return self.momenta(motion.acceleration(self.problem.system, self.displacement(y)))

    def energy(self, y: Floats) -> float:
        """Energy at rest at coordinates [mode], in units of m V^2."""
        x = self.displacement(y)
        return float(motion.energy(self.problem.system, x, np.zeros_like(x)))

    def flow(self, y: Floats, period: float, vectors: int) -> tangent.TangentFlow:
        """The motion from coordinates [mode], with so many tangent vectors."""
        flow = tangent.make_flow(self.problem, vectors, 0.5 * period / self.steps)
        flow.state.x[1:-1], flow.state.v[:] = self.displacement(y).T, 0.0
        return flow

    def mismatch(self, y: Floats, period: float) -> tuple[Floats, Floats, Floats]:
        """Momenta [mode] at half a period, and their derivatives by coordinates [mode, mode] and by the period."""
        count = len(y)
        flow = self.flow(y, period, count)
        vectors = np.zeros((count, 2, *self.modes.shapes.shape[1:]))
        vectors[:, 0] = self.modes.shapes / self.modes.frequency[:, np.newaxis, np.newaxis]
        flow.put(vectors)
        flow.advance(0, self.steps)
        acceleration = motion.acceleration(self.problem.system, flow.state.x[1:-1].T)
        return (
            self.momenta(flow.state.v[1:-1].T),
            self.momenta(flow.vectors[:, 1]).T,
            0.5 * self.momenta(acceleration),
        )

    def of_energy(self, energy: float) -> Condition:
        """Condition that a state has an energy, in units of m V^2."""
        size = math.sqrt(2.0 * energy)

        def condition(y: Floats, _: float) -> tuple[float, Floats, float]:
            """Difference of the energy at coordinates [coordinate], and its derivatives by these and the period."""
            slope = -self.force(y) / self.modes.frequency
            return (self.energy(y) - energy) / size, slope / size, 0.0

        return condition

    def samples(self, state: PeriodicState) -> tuple[Floats, Floats]:
        """Displacements and velocities, [time, line, bead] each, at evenly spaced times from 0 to half a period."""
        flow = self.flow(state.y, state.period, 0)
        steps = self.steps // SAMPLES
        frames = []
        for sample in range(SAMPLES + 1):
            frames.append(np.stack([flow.state.x[1:-1].T, flow.state.v[1:-1].T]))
            if sample < SAMPLES:
                flow.advance(sample * steps, steps)
        displacement, velocity = np.swapaxes(np.array(frames), 0, 1)
        return displacement, velocity


# --- branches ---------------------------------------------------------------------------------------------------------


def first_state(shooting: Shooting, mode: int, energy: float) -> Corrected | None:
    """The state of an energy near a linear mode, counted from 0 among those of nonzero frequency."""
    y = np.zeros(len(shooting.modes.frequency))
    y[mode] = math.sqrt(2.0 * energy)
    period = 2.0 * math.pi / float(shooting.modes.frequency[mode])
    return shooting.corrected(y, period, shooting.of_energy(energy))


def follow(shooting: Shooting, mode: int, energy: float, points: int) -> Branch:
    """The branch of a linear mode from `START` up to an energy, or a number of states.

    Args:
        shooting: how states are found.
        mode: number of the mode from 0, among those of nonzero frequency.
        energy: largest energy, in units of m V^2.
        points: largest number of states.
    """
    start = first_state(shooting, mode, START * energy)
    if start is None:
        return Branch([], [], "Newton's method does not converge at the first state")

    def end(last: PeriodicState, following: PeriodicState) -> tuple[PeriodicState | None, str] | None:
        reached = shooting.energy(following.y)
        if reached >= energy:
            state = at_energy(shooting, last, following, energy)
            return state, "" if state is not None else NO_CONVERGENCE
        return (None, "the branch returns to rest") if reached < START * energy else None

    growing = Direction(start.state.y / np.linalg.norm(start.state.y), 0.0)
    return continued(shooting, start, growing, points, end)


def at_energy(shooting: Shooting, first: PeriodicState, second: PeriodicState, energy: float) -> PeriodicState | None:
    """The state of an energy between two neighbouring states; None where Newton's method does not converge."""
    low, high = (math.log(shooting.energy(state.y)) for state in (first, second))
    share = (math.log(energy) - low) / (high - low)
    corrected = shooting.corrected(*between(first, second, share), shooting.of_energy(energy))
    return None if corrected is None else corrected.state
