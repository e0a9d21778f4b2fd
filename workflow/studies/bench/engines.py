"""The reference integrator against SciPy's, and a collision beside a force, in chains of any length."""

import statistics
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, System, physics
from lammps_inputs.ingredients import coupled_chains
from lammps_inputs.units import DIMENSIONLESS
from workflow.engines import collisions
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import accurate_reference
from workflow.studies.bench.runs import scene
from workflow.studies.bench.study import Ratio, make_ratio, ratio_of, seconds

# --- reference --------------------------------------------------------------------------------------------------------


def reference_ratios(_root: Path) -> Iterator[Ratio]:
    """Work at an error of 1e-6 in all velocities at the end."""
    problem = scene(2, 120, 192.0).problem()
    exact = last_velocities(problem, accurate_reference(problem, 1e-9).steps_per_frame)

    def enough(found: Floats) -> bool:
        return float(np.max(np.abs(found - exact))) <= 1e-6

    ours = next((steps for steps in (1, 2, 4, 8, 16) if enough(last_velocities(problem, steps))), 32)
    tolerances = (10.0**power for power in range(-7, -12, -1))
    tolerance = next((one for one in tolerances if enough(scipy_velocities(problem, one))), 1e-12)
    ends, pairs = problem.coarser(problem.frames), []
    for _ in range(3):
        first = min(seconds(lambda: engine.run(ends, steps_per_frame=ours * problem.frames)) for _ in range(3))
        pairs.append((first, seconds(lambda: scipy_velocities(problem, tolerance))))
    yield ratio_of("scipy DOP853 / reference at an error of 1e-6", pairs, 100.0)


def last_velocities(problem: Problem, steps_per_frame: int) -> Floats:
    """Velocities at the end, [chain, bead], by the reference."""
    last = problem.coarser(problem.frames)
    return np.asarray(engine.run(last, steps_per_frame=steps_per_frame * problem.frames).velocity[-1])


def scipy_velocities(problem: Problem, tolerance: float) -> Floats:
    """The same by scipy's DOP853 on the vectorised right-hand side."""
    shape = (problem.chains, problem.beads)
    count = problem.chains * problem.beads

    def slope(_: float, state: Floats) -> Floats:
        acceleration = motion.acceleration(problem.system, state[:count].reshape(shape))
        return np.concatenate([state[count:], acceleration.ravel()])

    start = np.concatenate([np.zeros(count), physics.initial_velocity(problem.system).ravel()])
    span = (0.0, problem.duration)
    found = solve_ivp(slope, span, start, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=span[1:])
    return np.asarray(found.y[count:, -1].reshape(shape))


# --- collisions -------------------------------------------------------------------------------------------------------

EVENTS = 100_000
ROWS = (100, 1_000, 10_000, 100_000)
PER_ROW = 3
"""Collisions of one row that are timed: the same early part of the motion whatever the length."""


def collision_ratios(_root: Path) -> Iterator[Ratio]:
    """A collision beside a force at N = 2, and in chains of 100 to 100,000 rows; about 20 s."""
    collisions.run(crowd(100), max_events=1)  # loads the compiled loop
    pairs = [(collision_seconds(1_000), force_seconds(crowd(1_000))) for _ in range(7)]
    yield ratio_of("a force on all 2 x 1000 beads in numpy / a collision", pairs, 40.0)
    rounds = [[collision_seconds(rows) for rows in ROWS] for _ in range(5)]
    value = statistics.median(max(each) / each[0] for each in rounds)
    medians = [1e6 * statistics.median(each) for each in zip(*rounds, strict=True)]
    detail = ", ".join(f"{rows:,}: {each:.2f} us" for rows, each in zip(ROWS, medians, strict=True))
    name = f"largest cost of a collision in up to {ROWS[-1]:,} rows / in {ROWS[0]}"
    yield make_ratio(name, value, 1.3, detail, below=True)


def force_seconds(problem: Problem, times: int = 2000) -> float:
    """Of the forces on all beads by arrays."""
    displacement = np.random.default_rng(0).normal(scale=0.1, size=(problem.chains, problem.beads))
    return seconds(lambda: [motion.acceleration(problem.system, displacement) for _ in range(times)]) / times


def collision_seconds(rows: int) -> float:
    """Of the processor for one collision, without the start, which predicts every pair once."""
    count, found = PER_ROW * rows, []
    for seed in range(max(1, EVENTS // count)):
        problem = crowd(rows, seed)
        start, whole = (
            seconds(lambda: collisions.run(problem, max_events=events), time.process_time)  # noqa: B023
            for events in (0, count)
        )
        found.append((whole - start) / count)
    return statistics.mean(found)


def crowd(rows: int, seed: int = 0) -> Problem:
    """Two chains in which every bead is kicked at random, theta = 1, with no end in sight."""
    random = np.random.default_rng(seed)
    velocity = random.choice([-1.0, 1.0], (2, rows)) * random.uniform(0.2, 1.0, (2, rows))
    velocity /= np.abs(velocity).max()
    kicks = tuple((chain + 1, row + 1, float(velocity[chain, row])) for row in range(rows) for chain in range(2))
    return Problem(
        name="crowd",
        system=System(chains=2, beads=rows, kicks=kicks, links=coupled_chains(2, 0.5, 1.0)),
        timestep=1e6,
        steps_per_frame=1,
        frames=1,
        recorded=None,
        scale=DIMENSIONLESS,
    )
