"""Periodic states of a conservative system, by shooting over half a period, and branches of them.

A state at rest, v(0) = 0, whose beads are all at rest again at T / 2 returns to its start at T, since forces do not
depend on velocity: the second half of the motion is the first in reverse. The unknowns are displacements x(0) and the
period T. The Jacobian is the tangent flow's, the derivative of the computed map; that with respect to the period is the
acceleration at T / 2, which differs from the computed map's by the error of the scheme.

Displacements are those of the linear modes of nonzero frequency omega: ``y = omega q``, with the modal coordinates q,
so that the energy is half of ``|y|^2`` near rest. Chains that are free to drift do so with none of these coordinates.
A branch is followed by pseudo-arclength continuation (Keller, in Applications of Bifurcation Theory, 1977), which
passes folds; lengths are relative to the size of the last state, as states grow over decades of energy.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem
from workflow.engines.reference import tangent
from workflow.studies.modes.linear import LinearModes, mass_of_atoms

RESIDUAL = 1e-12
"""Residual, over the size of a state, at which Newton's method ends."""

ROUNDED = 1e-9
"""Residual at which it also ends, where rounding prevents that it falls further."""

ITERATIONS = 8
"""Largest number of Newton steps; it converges quadratically."""

FEW, MANY = 3, 5
"""Newton steps up to which the next step along a branch is longer, and from which on shorter."""

FIRST, LONGEST, SHORTEST = 0.05, 0.2, 1e-5
"""Steps along a branch, over the size of the state; 0.2 is a factor of 1.5 in the energy."""

STRAIGHT = 0.9
"""Least cosine between directions of a branch at two neighbouring states."""

START = 1e-4
"""Energy of the first state of a branch, over the largest."""

SAMPLES = 32
"""Times in half a period at which the motion is sampled; the number of steps is a multiple of it."""

Condition = Callable[[Floats, float], tuple[float, Floats, float]]
"""Value of one more equation at coordinates and a period, and its slopes with respect to both."""


@dataclass(frozen=True)
class PeriodicState:
    """A periodic state.

    Attributes:
        y: [mode] coordinates at the start, where all velocities are 0, in units of V and the root of m.
        period: in units of T.
        residual: norm of the velocities at half a period over that of ``y``, masses as weights.
    """

    y: Floats
    period: float
    residual: float


class Direction(NamedTuple):
    """Direction of a branch: changes of coordinates over the size of the state, and of the period over the period."""

    y: Floats
    period: float


class Corrected(NamedTuple):
    """A state that Newton's method has found, and how.

    Attributes:
        state: the state.
        iterations: Newton steps.
        by_y, by_period: derivatives of the momenta at half a period, [mode, mode] and [mode].
    """

    state: PeriodicState
    iterations: int
    by_y: Floats
    by_period: Floats


@dataclass(frozen=True)
class Shooting:
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

    def half_period(self, y: Floats, period: float) -> tuple[Floats, Floats, Floats]:
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
            slope = -self.force(y) / self.modes.frequency
            return (self.energy(y) - energy) / size, slope / size, 0.0

        return condition

    def corrected(self, y: Floats, period: float, condition: Condition) -> Corrected | None:
        """The periodic state near coordinates [mode] that meets a condition; None without convergence."""
        first, before = period, math.inf
        for iteration in range(ITERATIONS + 1):
            momenta, by_y, by_period = self.half_period(y, period)
            value, slope, slope_of_period = condition(y, period)
            size = float(np.linalg.norm(y))
            residual = float(np.linalg.norm(momenta)) / size
            error = max(residual, abs(value) / size)
            if error <= RESIDUAL or (0.3 * before < error <= ROUNDED):
                return Corrected(PeriodicState(y, period, residual), iteration, by_y, by_period)
            if not error < 1.0:
                return None
            before = error
            matrix = np.block([[by_y, by_period[:, np.newaxis]], [slope, slope_of_period]])
            change = _solution(matrix, np.append(momenta, value))
            if change is None:
                return None
            y, period = y - change[:-1], period - float(change[-1])
            if not 0.5 < period / first < 2.0:
                return None
        return None

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


def _solution(matrix: Floats, right: Floats) -> Floats | None:
    """Solution of linear equations; None where there is none that is finite."""
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return None
    return np.asarray(solution, dtype=np.float64) if np.all(np.isfinite(solution)) else None


# --- branches ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Branch:
    """Periodic states of one family, in order along it.

    Attributes:
        states: at increasing arclength.
        directions: of the branch at each state.
        why: why it ends before the largest energy; empty where it reaches that.
    """

    states: list[PeriodicState]
    directions: list[Direction]
    why: str


def direction_at(corrected: Corrected, before: Direction) -> Direction | None:
    """Direction of a branch at a state, in the sense of that at the state before; None where branches cross."""
    size, period = float(np.linalg.norm(corrected.state.y)), corrected.state.period
    rows = np.hstack([size * corrected.by_y, period * corrected.by_period[:, np.newaxis]])
    matrix = np.vstack([rows / size, [*before.y, before.period]])
    solution = _solution(matrix, np.append(np.zeros(len(rows)), 1.0))
    if solution is None:
        return None
    solution /= np.linalg.norm(solution)
    return Direction(solution[:-1], float(solution[-1]))


def _on_plane(direction: Direction, y: Floats, period: float, size: float) -> Condition:
    """Condition that a state is on the plane through a point, to which a direction is perpendicular."""

    def condition(other: Floats, other_period: float) -> tuple[float, Floats, float]:
        value = direction.y @ (other - y) + direction.period * (other_period - period) * size / period
        return float(value), direction.y, direction.period * size / period

    return condition


def along_branch(shooting: Shooting, state: PeriodicState, direction: Direction, length: float) -> Corrected | None:
    """The state of a branch at a length from another, over its size; None where Newton's method does not converge."""
    size = float(np.linalg.norm(state.y))
    y, period = state.y + length * size * direction.y, state.period * (1.0 + length * direction.period)
    return shooting.corrected(y, period, _on_plane(direction, y, period, size))


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
    growing = Direction(start.state.y / np.linalg.norm(start.state.y), 0.0)
    directions, states = [direction_at(start, growing) or growing], [start.state]
    length = FIRST
    while len(states) < points:
        corrected = along_branch(shooting, states[-1], directions[-1], length)
        direction = None if corrected is None else direction_at(corrected, directions[-1])
        if corrected is None or direction is None or corrected.iterations > MANY or _turned(direction, directions[-1]):
            length *= 0.5
            if length < SHORTEST:
                return Branch(states, directions, "Newton's method does not converge beyond")
            continue
        reached = shooting.energy(corrected.state.y)
        if reached >= energy:
            last = at_energy(shooting, states[-1], corrected.state, energy)
            if last is not None:
                states.append(last)
                directions.append(direction)
            return Branch(states, directions, "" if last is not None else "Newton's method does not converge beyond")
        if reached < START * energy:
            return Branch(states, directions, "the branch returns to rest")
        states.append(corrected.state)
        directions.append(direction)
        if corrected.iterations <= FEW:
            length = min(1.5 * length, LONGEST)
    return Branch(states, directions, f"it has {points} states, as many as `--points` allows")


def _turned(direction: Direction, before: Direction) -> bool:
    return float(direction.y @ before.y) + direction.period * before.period < STRAIGHT


def between(first: PeriodicState, second: PeriodicState, share: float) -> tuple[Floats, float]:
    """Coordinates [mode] and period at a share of the way from one state to another."""
    return first.y + share * (second.y - first.y), first.period + share * (second.period - first.period)


def at_energy(shooting: Shooting, first: PeriodicState, second: PeriodicState, energy: float) -> PeriodicState | None:
    """The state of an energy between two neighbouring states; None where Newton's method does not converge."""
    low, high = (math.log(shooting.energy(state.y)) for state in (first, second))
    share = (math.log(energy) - low) / (high - low)
    corrected = shooting.corrected(*between(first, second, share), shooting.of_energy(energy))
    return None if corrected is None else corrected.state


def halfway(shooting: Shooting, first: PeriodicState, second: PeriodicState) -> PeriodicState | None:
    """The state in the middle between two neighbouring states; None where Newton's method does not converge."""
    y, period = between(first, second, 0.5)
    size = float(np.linalg.norm(y))
    step = Direction((second.y - first.y) / size, (second.period - first.period) / period)
    corrected = shooting.corrected(y, period, _on_plane(step, y, period, size))
    return None if corrected is None else corrected.state


def with_steps(shooting: Shooting, factor: int) -> Shooting:
    """Shooting with more steps in half a period."""
    return replace(shooting, steps=shooting.steps * factor)
