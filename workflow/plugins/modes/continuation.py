"""Newton's method for periodic states, and pseudo-arclength continuation of branches of them (Keller 1977).

The shooting method (`Continuable`) says what a state's coordinates are, and what is 0 for it. Lengths along a branch
are relative to the size of the last state, as states grow over decades. Continuation passes folds.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from granchain.parts import Floats

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

Condition = Callable[[Floats, float], tuple[float, Floats, float]]
"""Value of one more equation at coordinates and a period, and its slopes with respect to both."""


@dataclass(frozen=True)
class PeriodicState:
    """A periodic state.

    Attributes:
        y: [coordinate] at the start, as the method has them.
        period: in units of T.
        residual: norm of the method's mismatch over that of ``y``.
    """

    y: Floats
    period: float
    residual: float


class Direction(NamedTuple):
    """Direction of a branch.

    Attributes:
        y: changes of coordinates over the size of the state, [coordinate].
        period: change of the period over the period, times the method's `Continuable.stretch`.
    """

    y: Floats
    period: float


class Corrected(NamedTuple):
    """A state that Newton's method has found, and how.

    Attributes:
        state: the state.
        iterations: Newton steps.
        by_y, by_period: derivatives of the mismatch, [coordinate, coordinate] and [coordinate].
    """

    state: PeriodicState
    iterations: int
    by_y: Floats
    by_period: Floats


class Continuable:
    """A shooting method, whose states are found by Newton's method and followed along branches."""

    stretch: float = 1.0
    """Weight of relative changes of the period in lengths along a branch."""

    def mismatch(self, y: Floats, period: float) -> tuple[Floats, Floats, Floats]:
        """What is 0 for a periodic state, [coordinate], and its derivatives.

        Args:
            y: [coordinate].
            period: in units of T.

        Returns:
            The mismatch, its derivatives by coordinates, [coordinate, coordinate], and by the period, [coordinate].
        """
        raise NotImplementedError

    def on_plane(self, direction: Direction, y: Floats, period: float, size: float) -> Condition:
        """Condition that a state is on the plane through a point, y [coordinate] and period, normal to a direction."""
        weight = direction.period * self.stretch * size / period

        def condition(other: Floats, other_period: float) -> tuple[float, Floats, float]:
            """Distance from the plane, and its derivatives by coordinates [coordinate] and period."""
            return float(direction.y @ (other - y) + weight * (other_period - period)), direction.y, weight

        return condition

    def corrected(self, y: Floats, period: float, condition: Condition) -> Corrected | None:
        """The periodic state near coordinates [coordinate] that meets a condition; None without convergence."""
        first, before = period, math.inf
        for iteration in range(ITERATIONS + 1):
            mismatch, by_y, by_period = self.mismatch(y, period)
            value, slope, slope_of_period = condition(y, period)
            size = float(np.linalg.norm(y))
            residual = float(np.linalg.norm(mismatch)) / size
            error = max(residual, abs(value) / size)
            if error <= RESIDUAL or (0.3 * before < error <= ROUNDED):
                return Corrected(PeriodicState(y, period, residual), iteration, by_y, by_period)
            if not error < 1.0:
                return None
            before = error
            matrix = np.block([[by_y, by_period[:, np.newaxis]], [slope, slope_of_period]])
            change = _solution(matrix, np.append(mismatch, value))
            if change is None:
                return None
            y, period = y - change[:-1], period - float(change[-1])
            if not 0.5 < period / first < 2.0:
                return None
        return None


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


End = Callable[[PeriodicState, PeriodicState], tuple[PeriodicState | None, str] | None]
"""From the last state of a branch and the next: None to go on, or the last state to add, if any, and why it ends."""

NO_CONVERGENCE = "Newton's method does not converge beyond"


def direction_at(method: Continuable, corrected: Corrected, before: Direction) -> Direction | None:
    """Direction of a branch at a state, in the sense of that at the state before; None where branches cross."""
    size, period = float(np.linalg.norm(corrected.state.y)), corrected.state.period
    rows = np.hstack([size * corrected.by_y, (period / method.stretch) * corrected.by_period[:, np.newaxis]])
    matrix = np.vstack([rows / size, [*before.y, before.period]])
    solution = _solution(matrix, np.append(np.zeros(len(rows)), 1.0))
    if solution is None:
        return None
    solution /= np.linalg.norm(solution)
    return Direction(solution[:-1], float(solution[-1]))


def along_branch(method: Continuable, state: PeriodicState, direction: Direction, length: float) -> Corrected | None:
    """The state of a branch at a length from another, over its size; None where Newton's method does not converge."""
    size = float(np.linalg.norm(state.y))
    y, period = state.y + length * size * direction.y, state.period * (1.0 + length * direction.period / method.stretch)
    return method.corrected(y, period, method.on_plane(direction, y, period, size))


def _turned(direction: Direction, before: Direction) -> bool:
    return float(direction.y @ before.y) + direction.period * before.period < STRAIGHT


def between(first: PeriodicState, second: PeriodicState, share: float) -> tuple[Floats, float]:
    """Coordinates [coordinate] and period at a share of the way from one state to another."""
    return first.y + share * (second.y - first.y), first.period + share * (second.period - first.period)


def halfway(method: Continuable, first: PeriodicState, second: PeriodicState) -> PeriodicState | None:
    """The state in the middle between two neighbouring states; None where Newton's method does not converge."""
    y, period = between(first, second, 0.5)
    size = float(np.linalg.norm(y))
    step = Direction((second.y - first.y) / size, method.stretch * (second.period - first.period) / period)
    corrected = method.corrected(y, period, method.on_plane(step, y, period, size))
    return None if corrected is None else corrected.state


def continued(method: Continuable, start: Corrected, growing: Direction, points: int, end: End) -> Branch:
    """The branch through a state.

    Args:
        method: how states are found.
        start: the first state.
        growing: roughly the direction in which the branch is followed.
        points: largest number of states.
        end: says after each state whether the branch ends.
    """
    directions, states = [direction_at(method, start, growing) or growing], [start.state]
    length = FIRST
    while len(states) < points:
        corrected = along_branch(method, states[-1], directions[-1], length)
        direction = None if corrected is None else direction_at(method, corrected, directions[-1])
        if corrected is None or direction is None or corrected.iterations > MANY or _turned(direction, directions[-1]):
            length *= 0.5
            if length < SHORTEST:
                return Branch(states, directions, NO_CONVERGENCE)
            continue
        ended = end(states[-1], corrected.state)
        if ended is not None:
            last, why = ended
            if last is not None:
                states.append(last)
                directions.append(direction)
            return Branch(states, directions, why)
        states.append(corrected.state)
        directions.append(direction)
        if corrected.iterations <= FEW:
            length = min(1.5 * length, LONGEST)
    return Branch(states, directions, f"it has {points} states, as many as `--points` allows")
