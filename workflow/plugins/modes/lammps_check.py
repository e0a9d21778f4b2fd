"""LAMMPS started on a periodic state: whether it returns after a period, and how fast it leaves an unstable one.

LAMMPS integrates by velocity Verlet with a fixed step, so that it returns up to an error of order 2 in the step. For
the growth two runs are compared: one on the state, one displaced by a small multiple of the unstable direction. Their
difference, in the coordinate of that multiplier (its left eigenvector), grows by the multiplier's modulus each period.
"""

import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, deck, file_names, numbers, physics, rates, recording, run_deck
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes.branches import shooting_of
from workflow.plugins.modes.continuation import PeriodicState
from workflow.plugins.modes.floquet import monodromy
from workflow.plugins.modes.linear import free_atoms, linear_modes
from workflow.plugins.modes.shooting import Shooting

STEPS = 800
"""Steps of LAMMPS in a period, at least; the second run has twice as many."""

PER_BOUND = 8.0
"""Steps in the stability bound, at least."""

PERIODS = 100
"""Periods of a run on a stable state."""

SEED = 1e-6
"""Size of a displacement along the unstable direction, over that of the state."""

FARTHEST = 1e-3
"""Largest distance, over the size of the state, up to which growth counts as exponential."""

LEFT = 0.05
"""Largest distance of the run on the state from the state, over its size, up to which growth is measured."""

LEAST_GROWTH, LONGEST = 3.0, 400
"""Logarithm of the least growth that is measured, within so many periods."""

START = "in.start"
"""File of the commands that set positions and velocities."""


def lammps_problem(problem: Problem, energy: float, period: float, steps: int, periods: int) -> Problem:
    """Problem of LAMMPS for some periods of a state, a frame each; one kick of its energy sets the beads' diameter."""
    chain, bead = np.argwhere(free_atoms(problem.system)[: problem.chains])[0].tolist()
    speed = math.sqrt(2.0 * energy / float(physics.mass_of(problem.system, chain, bead)))
    system = replace(problem.system, kicks=((chain + 1, bead + 1, speed),), start=None)
    rows = problem.rows.only(None)
    return replace(problem, system=system, timestep=period / steps, steps_per_frame=steps, frames=periods, rows=rows)


def steps_per_period(problem: Problem, period: float) -> int:
    """Steps of LAMMPS in a period of the first run."""
    return max(STEPS, math.ceil(PER_BOUND * period / rates.stability_bound(problem.system)))


def deck_files(problem: Problem, displacement: Floats, velocity: Floats) -> dict[str, str]:
    """Deck that starts at displacements and velocities, [line, bead] in units of L and V, by file name."""
    opening = float(np.max(np.diff(displacement[: problem.chains], axis=-1), initial=0.0))
    places = problem.layout.places[problem.system.chain_of_line] + displacement
    lines = [
        f"set atom {atom} x {numbers.text(places.flat[atom - 1])} vx {numbers.text(velocity.flat[atom - 1])}"
        for atom in physics.atom_ids(problem.system).tolist()
    ]
    return {
        file_names.DECK: deck.render_deck(problem, [f"include {START}"], opening),
        file_names.DATA: deck.render_data(problem),
        START: "\n".join(lines) + "\n",
    }


def computed(plain: dict[str, Any], source: str, mode: int, state: dict[str, Any], steps: int) -> dict[str, Any]:
    """What LAMMPS makes of a state, as plain data.

    Args:
        plain: the scene.
        source: its name in messages.
        mode: number of the state's linear mode, from 0.
        state: plain data of `workflow.plugins.modes.branches`.
        steps: steps of the reference in a period.

    Returns:
        ``steps`` in a period of the first run; ``velocity`` and ``distance`` from the start after a period, norms over
        all atoms, for it and for twice the steps; ``periods``, and ``later``, the distance after so many of a stable
        state; ``growth`` and ``fitted``, its standard error, for both, and ``predicted``, rates in 1 / T of an unstable
        state; None where it is not measured.
    """
    problem = tangent.problem_of(plain, source)
    period, x = float(state["period"]), np.array(state["x"])
    count = steps_per_period(problem, period)
    growth = math.log(state["largest"]) if not state["stable"] else 0.0
    measured = growth * LONGEST > LEAST_GROWTH
    periods = min(LONGEST, math.ceil(math.log(FARTHEST / SEED) / growth) + 2) if measured else PERIODS
    still = np.zeros_like(x)
    problems = [lammps_problem(problem, state["energy"], period, factor * count, periods) for factor in (1, 2)]
    if state["stable"]:
        problems[1] = replace(problems[1], frames=1)
    runs = [run(finite, x, still) for finite in problems]
    value: dict[str, Any] = {
        "steps": count,
        "velocity": [float(np.linalg.norm(velocity[1])) for _, velocity in runs],
        "distance": [float(np.linalg.norm(displacement[1] - x)) for displacement, _ in runs],
        "periods": periods,
        "later": float(np.linalg.norm(runs[0][0][-1] - x)) if state["stable"] else None,
    }
    if not measured:
        return value | {"growth": None, "fitted": None, "predicted": None}
    solver = replace(shooting_of(problem, linear_modes(problem, source), mode), steps=steps // 2)
    growths = [_growth_rate(solver, state, run, base) for run, base in zip(problems, runs, strict=True)]
    return value | {
        "growth": [None if rate is None else rate[0] / period for rate in growths],
        "fitted": [None if rate is None else rate[1] / period for rate in growths],
        "predicted": growth / period,
    }


def run(problem: Problem, displacement: Floats, velocity: Floats) -> tuple[Floats, Floats]:
    """Displacements and velocities, [frame, line, bead] each, of a run of LAMMPS."""
    with tempfile.TemporaryDirectory(prefix="granchain-modes-") as name:
        directory = Path(name)
        for file, content in deck_files(problem, displacement, velocity).items():
            (directory / file).write_text(content, encoding="utf-8", newline="\n")
        run_deck(directory, problem=problem)
        return recording.read([directory / file_names.DUMP], problem).atoms


def _coordinates(solver: Shooting, displacement: Floats, velocity: Floats) -> Floats:
    """Canonical coordinates, [..., coordinate], of displacements and velocities [..., line, bead]."""
    root = np.sqrt(solver.modes.frequency)
    return np.concatenate([solver.momenta(displacement) * root, solver.momenta(velocity) / root], axis=-1)


def _growth_rate(
    solver: Shooting, state: dict[str, Any], problem: Problem, base: tuple[Floats, Floats]
) -> tuple[float, float] | None:
    """Growth of the logarithm of a small deviation in a period, and its standard error; None of too few periods.

    Args:
        solver: shooting for the state.
        state: its plain data.
        problem: LAMMPS's.
        base: displacements and velocities, [frame, line, bead], of the run on the state.
    """
    from scipy.linalg import eig

    x = np.array(state["x"])
    y = solver.momenta(x) * solver.modes.frequency
    matrix, _ = monodromy(solver, PeriodicState(y, state["period"], state["residual"]))
    values, left, right = eig(matrix, left=True, right=True)
    largest = max((complex(*pair) for pair in state["multipliers"]), key=abs)
    place = int(np.argmin(np.abs(values - largest)))
    start = _coordinates(solver, x, np.zeros_like(x))
    size = float(np.linalg.norm(start))
    direction = right[:, place].real / np.linalg.norm(right[:, place].real) * SEED * size
    count, root = len(y), np.sqrt(solver.modes.frequency)
    change = np.tensordot(direction[:count] / root, solver.modes.shapes, axes=1)
    change_of_velocity = np.tensordot(direction[count:] * root, solver.modes.shapes, axes=1)
    other = run(problem, x + change, change_of_velocity)
    deviation = _coordinates(solver, *other) - _coordinates(solver, *base)
    away = np.linalg.norm(_coordinates(solver, *base) - start, axis=-1)
    near = (np.linalg.norm(deviation, axis=-1) < FARTHEST * size) & (away < LEFT * size)
    frames = int(np.argmin(near)) if not np.all(near) else len(near)
    if frames < 3:
        return None
    logarithm = np.log(np.abs(deviation[:frames] @ left[:, place].conj()))
    (slope, _), covariance = np.polyfit(np.arange(frames), logarithm, 1, cov="unscaled")
    residuals = logarithm - np.polyval(np.polyfit(np.arange(frames), logarithm, 1), np.arange(frames))
    variance = float(np.sum(residuals**2)) / max(1, frames - 2)
    return float(slope), math.sqrt(variance * float(covariance[0, 0]))
