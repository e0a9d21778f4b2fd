"""One branch of periodic states as plain data: its states, their stability, and its bifurcations."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from granchain.parts import Problem, motion
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import shooting
from workflow.plugins.modes.continuation import Branch, Continuable, PeriodicState, halfway
from workflow.plugins.modes.floquet import KINDS, Multipliers, multipliers
from workflow.plugins.modes.linear import LinearModes, linear_modes, mass_of_atoms
from workflow.plugins.modes.shooting import Shooting

STEPS_PER_PERIOD = 40.0
"""Steps of the reference in a period of the fastest linear mode, at first."""

DIGITS = 1e-9
"""Largest relative change of the frequency by twice the steps; with more the branch is followed again with these."""

DOUBLINGS = 4
"""Largest number of times that the steps are doubled."""


Stability = Callable[[PeriodicState], Multipliers]


class Point(NamedTuple):
    """A state of a branch.

    Attributes:
        place: along the branch; whole numbers are those of the continuation.
        role: what it was computed for: "branch", "energy" or "bifurcation".
        state: the state.
        multipliers: its Floquet multipliers.
    """

    place: float
    role: str
    state: PeriodicState
    multipliers: Multipliers


@dataclass(frozen=True)
class Bifurcation:
    """A change of stability between two states.

    Attributes:
        kind: where the multipliers leave the unit circle, of `KINDS`; "fold" at 1 where the energy has an extremum.
        before, after: the last state with, and the first without, as many multipliers outside as before it.
        outside: number of multipliers outside the unit circle before and after.
    """

    kind: str
    before: Point
    after: Point
    outside: tuple[int, int]


def shooting_of(problem: Problem, modes: LinearModes, mode: int, doublings: int = 0) -> Shooting:
    """Shooting for a branch of a mode, counted from 0 among all, with its steps doubled some times."""
    half = 0.5 * STEPS_PER_PERIOD * float(modes.frequency[-1] / modes.frequency[mode])
    pieces = math.ceil(half / shooting.SAMPLES) * 2**doublings
    return Shooting(problem, modes.vibrations(), pieces * shooting.SAMPLES)


def computed(
    plain: dict[str, Any],
    source: str,
    mode: int,
    energy: float,
    points: int,
    energies: list[float],
    bisections: int,
) -> dict[str, Any]:
    """A branch of periodic states, as plain data.

    Args:
        plain: the scene.
        source: its name in messages.
        mode: number of the linear mode, from 0.
        energy: largest energy, in units of m V^2.
        points: largest number of states along the branch.
        energies: of further states, in units of m V^2.
        bisections: halvings of the interval of a bifurcation.

    Returns:
        ``steps`` in a period; ``uncertainty``, relative change of the last frequency by twice the steps; ``why`` the
        branch ends early; ``states`` in order, and ``bifurcations``, see `_state` and `_bifurcation`; ``motion``,
        displacements [time, line, bead] of the last state of the continuation, at even times up to half a period.
    """
    problem = tangent.problem_of(plain, source)
    modes = linear_modes(problem, source)
    solver, branch, uncertainty = _resolved(problem, modes, mode, energy, points)
    stability = partial(multipliers, solver)
    points_of_branch = [
        Point(float(place), "branch", state, stability(state)) for place, state in enumerate(branch.states)
    ]
    turns = [
        float(solver.force(state.y) @ (direction.y / solver.modes.frequency))
        for state, direction in zip(branch.states, branch.directions, strict=True)
    ]
    changes = list(changes_of_stability(solver, points_of_branch, turns, bisections, stability))
    further = [point for value in energies for point in _of_energy(solver, mode - modes.zeros, points_of_branch, value)]
    further += [change.after for change in changes if change.after.role == "bifurcation"]
    states = sorted([*points_of_branch, *further], key=lambda point: point.place)
    return {
        "steps": 2 * solver.steps,
        "uncertainty": uncertainty,
        "why": branch.why,
        "states": [_state(solver, point) for point in states],
        "bifurcations": [_bifurcation(solver, change) for change in changes],
        "motion": solver.samples(branch.states[-1])[0].tolist() if branch.states else [],
    }


def _resolved(
    problem: Problem, modes: LinearModes, mode: int, energy: float, points: int
) -> tuple[Shooting, Branch, float | None]:
    """Shooting with so many steps that twice as many hardly change the last frequency, the branch, and that change."""
    for doublings in range(DOUBLINGS + 1):
        solver = shooting_of(problem, modes, mode, doublings)
        branch = shooting.follow(solver, mode - modes.zeros, energy, points)
        if not branch.states:
            return solver, branch, None
        last = branch.states[-1]
        finer = shooting_of(problem, modes, mode, doublings + 1)
        corrected = finer.corrected(last.y, last.period, finer.of_energy(solver.energy(last.y)))
        change = None if corrected is None else abs(corrected.state.period / last.period - 1.0)
        if change is not None and change <= DIGITS:
            break
    return solver, branch, change


def _of_energy(solver: Shooting, mode: int, points: list[Point], energy: float) -> Iterator[Point]:
    """States of an energy on a branch: one for each pair of neighbours that it lies between, or near the mode."""
    levels = [solver.energy(point.state.y) for point in points]
    if levels and energy < levels[0]:
        corrected = shooting.first_state(solver, mode, energy)
        if corrected is not None:
            yield Point(-1.0 + energy / levels[0], "energy", corrected.state, multipliers(solver, corrected.state))
    for (first, low), (second, high) in pairwise(zip(points, levels, strict=True)):
        if low < energy < high or high < energy < low:
            state = shooting.at_energy(solver, first.state, second.state, energy)
            if state is not None:
                place = first.place + (energy - low) / (high - low)
                yield Point(place, "energy", state, multipliers(solver, state))
    for point, level in zip(points, levels, strict=True):
        if abs(energy - level) <= 1e-12 * level:
            yield point._replace(place=point.place, role="energy")


def changes_of_stability(
    method: Continuable, points: Sequence[Point], turns: Sequence[float], bisections: int, stability: Stability
) -> Iterator[Bifurcation]:
    """Changes of the number of multipliers outside the unit circle between neighbouring states.

    Args:
        method: how states are floquet.
        points: states of the continuation, in order.
        turns: of each state, a number whose sign changes where the branch turns back.
        bisections: halvings of the interval of a bifurcation.
        stability: multipliers of a state.
    """
    for place, (first, second) in enumerate(pairwise(points)):
        early, late = first.multipliers.outside(), second.multipliers.outside()
        for group, kind in enumerate(KINDS):
            if sum(early) != sum(late) and early[group] != late[group]:
                before, after = _bracket(method, (first, second), group, bisections, stability)
                name = "fold" if kind == "+1" and turns[place] * turns[place + 1] < 0.0 else kind
                yield Bifurcation(name, before, after, (sum(early), sum(late)))


def _bracket(
    method: Continuable, around: tuple[Point, Point], group: int, bisections: int, stability: Stability
) -> tuple[Point, Point]:
    """Two states around a change of the number of multipliers of a group (`Multipliers.outside`), closer together."""
    first, second = around
    number = first.multipliers.outside()[group]
    for _ in range(bisections):
        state = halfway(method, first.state, second.state)
        if state is None:
            break
        point = Point(0.5 * (first.place + second.place), "bifurcation", state, stability(state))
        if point.multipliers.outside()[group] == number:
            first = point
        else:
            second = point
    return first, second


def _state(solver: Shooting, point: Point) -> dict[str, Any]:
    """Plain data of a state, in units of V, T, L and m V^2; energies of atoms are kinetic ones, means over a period."""
    state, floquet, system = point.state, point.multipliers, solver.problem.system
    displacement, velocity = solver.samples(state)
    weights = np.full(shooting.SAMPLES + 1, 1.0 / shooting.SAMPLES)
    weights[[0, -1]] *= 0.5
    kinetic = 0.5 * mass_of_atoms(system) * np.tensordot(weights, velocity**2, axes=1)
    return {
        "place": point.place,
        "role": point.role,
        "x": displacement[0].tolist(),
        "period": state.period,
        "residual": state.residual,
        "energy": solver.energy(state.y),
        "multipliers": [[value.real, value.imag] for value in floquet.values.tolist()],
        "largest": floquet.largest,
        "stable": floquet.stable,
        "tolerance": floquet.tolerance,
        "asymmetry": floquet.asymmetry,
        "kinetic": kinetic.tolist(),
        "least_overlap": float(np.min(motion.overlaps(system, displacement[:, : system.chains]))),
    }


def _bifurcation(solver: Shooting, change: Bifurcation) -> dict[str, Any]:
    """Plain data of a bifurcation: kind, energies and frequencies of the states around it, numbers of multipliers."""
    return {
        "kind": change.kind,
        "place": change.after.place,
        "energies": [solver.energy(point.state.y) for point in (change.before, change.after)],
        "periods": [point.state.period for point in (change.before, change.after)],
        "outside": list(change.outside),
    }
