"""Periodic responses of a damped scene to a sinusoidal drive, over the frequency of the drive.

A response has the period of the drive. Its unknowns are displacements and velocities of all atoms that are free to
move, at phase 0 of the drive: those that a period returns to themselves. The Jacobian is the tangent flow's; that with
respect to the period is a difference of the computed map. The same branch has stable and unstable responses,
and folds where it turns back.

Velocities are the reference's, less impulses of dashpots over masses (`workflow.engines.reference.kernel`), which
changes no multiplier.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, engine, motion, physics
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes.branches import DOUBLINGS, Bifurcation, Point, changes_of_stability
from workflow.plugins.modes.continuation import (
    LONGEST,
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
from workflow.plugins.modes.driven import at_period, linear_response, moving_atoms
from workflow.plugins.modes.floquet import Multipliers

SAMPLES = 64
"""Times in a period at which the motion is sampled; the number of steps is a multiple of it."""

FINER = 1024
"""Times in a period between samples, by trigonometric interpolation: the largest of them is right to 5e-6."""

PIECES = 20.0
"""Steps along a branch, at least, in which the frequency passes its range."""

DIFFERENCE = 1e-7
"""Relative difference of the two periods whose maps give the derivative, which is as accurate."""

COARSER = 2
"""Steps of a run of the reference by default, over those of the first branch, which are often enough for `DIGITS`."""

DIGITS = 1e-7
"""Largest relative change of frequencies by twice the steps, at the largest response and beside folds."""

ROUNDING = 1e-9
"""Deviation of a multiplier's modulus from 1 that rounding can cause, over the norm of the matrix."""

SAME = 1e-12
"""Relative difference up to which two periods are the same."""

# --- shooting ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class DrivenShooting(Continuable):
    """Shooting over a period of the drive.

    Coordinates are displacements times an angular frequency, then velocities of the reference, of all moving atoms.

    Attributes:
        problem: what is integrated, with a drive of any frequency.
        steps: steps of the reference in a period.
        unit: angular frequency by which displacements are multiplied, in 1 / T.
        stretch: weight of relative changes of the period in lengths along a branch.
    """

    problem: Problem
    steps: int
    unit: float
    stretch: float

    def coordinates(self, x: Floats, w: Floats) -> Floats:
        """Coordinates [..., coordinate] of displacements and velocities of the reference, [..., line, bead]."""
        moving = moving_atoms(self.problem.system)
        return np.concatenate([self.unit * x[..., moving], w[..., moving]], axis=-1)

    def flow(self, y: Floats, period: float, vectors: int) -> tangent.TangentFlow:
        """The motion from coordinates [coordinate] at phase 0, with so many tangent vectors."""
        flow = tangent.make_flow(at_period(self.problem, period), vectors, period / self.steps)
        x, w = (part[1:-1].T for part in (flow.state.x, flow.state.v))
        moving = moving_atoms(self.problem.system)
        x[moving], w[moving] = y[: len(y) // 2] / self.unit, y[len(y) // 2 :]
        return flow

    def mapped(self, y: Floats, period: float) -> Floats:
        """Coordinates [coordinate] after a period."""
        flow = self.flow(y, period, 0)
        flow.advance(0, self.steps)
        return self.coordinates(flow.state.x[1:-1].T, flow.state.v[1:-1].T)

    def monodromy(self, y: Floats, period: float) -> tuple[Floats, Floats]:
        """Coordinates [coordinate] after a period, and their derivatives by those before it, [coordinate, same]."""
        flow, moving = self.flow(y, period, len(y)), moving_atoms(self.problem.system)
        half, unit = len(y) // 2, np.eye(len(y) // 2)
        vectors = np.zeros((len(y), 2, *moving.shape))
        vectors[:half, 0, moving], vectors[half:, 1, moving] = unit / self.unit, unit
        flow.put(vectors)
        flow.advance(0, self.steps)
        final = self.coordinates(flow.state.x[1:-1].T, flow.state.v[1:-1].T)
        return final, self.coordinates(*np.swapaxes(flow.vectors, 0, 1)).T

    def mismatch(self, y: Floats, period: float) -> tuple[Floats, Floats, Floats]:
        """Change of the coordinates [coordinate] by a period, and its derivatives, as the base class has them."""
        final, by_y = self.monodromy(y, period)
        late = self.mapped(y, period * (1.0 + DIFFERENCE))
        return final - y, by_y - np.eye(len(y)), (late - final) / (DIFFERENCE * period)

    def of_period(self, period: float, size: float) -> Condition:
        """Condition that a state of a size has a period."""
        return lambda y, other: ((other - period) * size / period, np.zeros_like(y), size / period)

    def linear(self, period: float) -> Corrected | None:
        """The response near the linear one of a period; None without convergence."""
        problem = at_period(self.problem, period)
        x, v = linear_response(problem)
        y = self.coordinates(x, engine.velocity_of_state(problem.system, x, v))
        return self.corrected(y, period, self.of_period(period, float(np.linalg.norm(y))))

    def between_neighbours(self, first: PeriodicState, second: PeriodicState, period: float) -> PeriodicState | None:
        """The response of a period between two neighbouring ones; None without convergence."""
        y, _ = between(first, second, (period - first.period) / (second.period - first.period))
        corrected = self.corrected(y, period, self.of_period(period, float(np.linalg.norm(y))))
        return None if corrected is None else corrected.state

    def multipliers(self, state: PeriodicState) -> Multipliers:
        """Floquet multipliers of a response."""
        _, matrix = self.monodromy(state.y, state.period)
        error = ROUNDING * max(1.0, float(np.linalg.norm(matrix, 2)))
        return Multipliers(np.linalg.eigvals(matrix), 0.0, error, error)

    def samples(self, state: PeriodicState) -> tuple[Floats, Floats]:
        """Displacements and velocities, [time, line, bead] each, at even times of a period, the first at phase 0."""
        flow, system = self.flow(state.y, state.period, 0), self.problem.system
        frames = flow.state.frame_arrays(SAMPLES, physics.lines(system), system.beads)
        recorded = np.arange(1, system.beads + 1)
        flow.state.advance(flow.scheme, state.period / self.steps, 0, self.steps // SAMPLES, recorded, frames)
        return np.roll(frames.x, 1, axis=0), np.roll(frames.v, 1, axis=0)


def largest(samples: Floats) -> Floats:
    """Largest sizes over a period, [...], of samples [time, ...] at even times, by trigonometric interpolation."""
    from scipy.signal import resample

    return np.asarray(np.max(np.abs(resample(samples, FINER, axis=0)), axis=0))


# --- the branch over the frequency ------------------------------------------------------------------------------------


def computed(
    plain: dict[str, Any],
    source: str,
    periods: tuple[float, float],
    points: int,
    further: Sequence[float],
    bisections: int,
) -> dict[str, Any]:
    """The branch of responses over the frequency, as plain data.

    Args:
        plain: the scene.
        source: its name in messages.
        periods: of the lowest and the highest frequency, in units of T.
        points: largest number of states along the branch.
        further: periods of further states.
        bisections: halvings of the interval of a bifurcation.

    Returns:
        ``steps`` in a period; ``uncertainty``, largest relative change of frequencies by twice the steps (`DIGITS`);
        ``why`` the branch ends early; ``states`` in order, see `_state`, and ``bifurcations``, see `_change`.
    """
    problem = tangent.problem_of(plain, source)
    solver, branch, uncertainty = _resolved(problem, periods, points)
    along = [Point(float(k), "branch", state, solver.multipliers(state)) for k, state in enumerate(branch.states)]
    turns = [direction.period for direction in branch.directions]
    changes = list(changes_of_stability(solver, along, turns, bisections, solver.multipliers))
    behind = [change.after for change in changes if change.after.role == "bifurcation"]
    states = [*along, *behind, *_of_periods(solver, along, further)]
    return {
        "steps": solver.steps,
        "uncertainty": uncertainty,
        "why": branch.why,
        "states": [_state(solver, point) for point in sorted(states, key=lambda point: point.place)],
        "bifurcations": [_change(along, change, uncertainty or 0.0) for change in changes],
    }


def _resolved(
    problem: Problem, periods: tuple[float, float], points: int
) -> tuple[DrivenShooting, Branch, float | None]:
    """Shooting with steps of which twice as many hardly change the largest response, the branch, and that change."""
    longest, shortest = periods
    one_period = replace(problem, timestep=longest, steps_per_frame=1)
    pieces = math.ceil(engine.default_steps_per_frame(one_period) / (COARSER * SAMPLES))
    stretch = PIECES * LONGEST / math.log(longest / shortest)
    change = None
    for doublings in range(DOUBLINGS + 1):
        steps = pieces * SAMPLES * 2**doublings
        solver = DrivenShooting(problem, steps, 2.0 * math.pi / math.sqrt(longest * shortest), stretch)
        branch = _followed(solver, periods, points)
        if not branch.states:
            break
        change = _change_by_steps(solver, branch)
        if change is not None and change <= DIGITS:
            break
    return solver, branch, change


def _change_by_steps(solver: DrivenShooting, branch: Branch) -> float | None:
    """Largest relative change of periods by twice the steps (`DIGITS`); None without convergence."""
    turns, change = [direction.period > 0.0 for direction in branch.directions], 0.0
    sizes = [float(np.linalg.norm(state.y)) for state in branch.states]
    checked = {int(np.argmax(sizes)), *(k for k in range(1, len(turns)) if turns[k] != turns[k - 1])}
    for k in checked:
        state = branch.states[k]
        plane = solver.on_plane(branch.directions[k], state.y, state.period, sizes[k])
        corrected = replace(solver, steps=2 * solver.steps).corrected(state.y, state.period, plane)
        if corrected is None:
            return None
        change = max(change, abs(corrected.state.period / state.period - 1.0))
    return change


def _followed(solver: DrivenShooting, periods: tuple[float, float], points: int) -> Branch:
    """The branch from the response near the linear one at the lowest frequency to an end of the range."""
    start = solver.linear(periods[0])
    if start is None:
        why = "Newton's method does not converge from the linear response at LOW; take another, farther from resonances"
        return Branch([], [], why)

    def end(last: PeriodicState, following: PeriodicState) -> tuple[PeriodicState | None, str] | None:
        for limit, beyond in zip(periods, (following.period > periods[0], following.period < periods[1]), strict=True):
            if beyond:
                state = solver.between_neighbours(last, following, limit)
                returns = "it returns to the lowest frequency" if limit == periods[0] else ""
                return state, NO_CONVERGENCE if state is None else returns
        return None

    return continued(solver, start, Direction(np.zeros_like(start.state.y), -1.0), points, end)


def _of_periods(solver: DrivenShooting, along: Sequence[Point], periods: Sequence[float]) -> Iterator[Point]:
    """States of given periods, one for each pair of neighbours that they lie between, and none that these have."""
    for (first, second), period in ((pair, period) for pair in pairwise(along) for period in periods):
        low, high = first.state.period, second.state.period
        apart = min(abs(period / low - 1.0), abs(period / high - 1.0)) > SAME
        if apart and min(low, high) < period < max(low, high):
            state = solver.between_neighbours(first.state, second.state, period)
            if state is not None:
                place = first.place + (period - low) / (high - low)
                yield Point(place, "frequency", state, solver.multipliers(state))


def _state(solver: DrivenShooting, point: Point) -> dict[str, Any]:
    """Plain data of a state, in units of V, T, L and m V^2; ``speed`` and ``travel`` are the largest of each atom."""
    x, v = solver.samples(point.state)
    system = solver.problem.system
    return {
        "place": point.place,
        "role": point.role,
        "x": x[0].tolist(),
        "v": v[0].tolist(),
        "period": point.state.period,
        "residual": point.state.residual,
        "energy": float(np.max(motion.energy(system, x, v))),
        "speed": largest(v).tolist(),
        "multipliers": [[value.real, value.imag] for value in point.multipliers.values.tolist()],
        "largest": float(np.max(np.abs(point.multipliers.values))),
        "stable": point.multipliers.stable,
        "least_overlap": float(np.min(motion.overlaps(system, x[:, : system.chains]))),
    }


def _change(along: Sequence[Point], change: Bifurcation, uncertainty: float) -> dict[str, Any]:
    """Plain data of a bifurcation: kind, frequency in cycles per T with its uncertainty, and numbers of multipliers."""
    first, second = 1.0 / change.before.state.period, 1.0 / change.after.state.period
    error = 0.5 * abs(second - first) + uncertainty * first
    if change.kind == "fold":
        # the frequency is a parabola of the place, whose curvature follows from the states of the continuation around
        low = min(int(change.before.place), len(along) - 2)
        height = max(abs(1.0 / point.state.period - first) for point in along[low : low + 2])
        error += 4.0 * height * (change.after.place - change.before.place) ** 2
    return {
        "kind": "Neimark-Sacker" if change.kind == "collision" else change.kind,
        "place": change.after.place,
        "frequency": 0.5 * (first + second),
        "uncertainty": error,
        "outside": list(change.outside),
    }
