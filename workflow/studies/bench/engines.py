"""The reference integrator against SciPy's, and a collision beside a force, in chains of any length."""

import statistics
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, System, physics
from lammps_inputs.ingredients import coupled_chains
from lammps_inputs.units import Scale
from workflow.engines import collisions
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import BLANES_MOAN
from workflow.engines.reference.step_halving import accurate_reference
from workflow.studies.bench.alternatives import paper_scene, seconds
from workflow.studies.bench.study import Ratio, make_ratio, ratio_of

# --- reference --------------------------------------------------------------------------------------------------------


def reference_against_scipy(_root: Path) -> Iterator[Ratio]:
    """Work at an error of 1e-6 in all velocities at the end, and the cost of a force."""
    problem = paper_scene().problem()
    truth = accurate_reference(problem, 1e-9)
    exact = last_velocities(problem, truth.steps_per_frame)
    ours = next(
        (steps for steps in (1, 2, 4, 8, 16, 32) if np.max(np.abs(last_velocities(problem, steps) - exact)) <= 1e-6), 32
    )
    tolerance = next(
        (
            tolerance
            for tolerance in (1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
            if np.max(np.abs(scipy_velocities(problem, tolerance) - exact)) <= 1e-6
        ),
        1e-12,
    )
    ends = problem.coarser(problem.frames)
    pairs = []
    for _ in range(3):
        first = min(seconds(lambda: engine.run(ends, steps_per_frame=ours * problem.frames)) for _ in range(3))
        pairs.append((first, seconds(lambda: scipy_velocities(problem, tolerance))))
    yield ratio_of("scipy DOP853 / reference at an error of 1e-6", pairs, 100.0)
    steps = 8 * problem.frames
    costs = [(kernel_cost(ends, steps), numpy_cost(problem)) for _ in range(7)]
    yield ratio_of("a force in numpy / in the kernel", costs, 50.0)


def kernel_cost(problem: Problem, steps: int) -> float:
    """Seconds a force evaluation of all beads, all rows integrated from the start to the one frame."""
    system = replace(problem.system, kicks=((1, 1, 1.0), (1, problem.beads, -1e-3)))
    hit_at_both_ends = replace(problem, system=system)
    took = seconds(lambda: engine.run(hit_at_both_ends, steps_per_frame=steps))
    return took / (steps * BLANES_MOAN.forces_per_step)


def numpy_cost(problem: Problem, times: int = 2000) -> float:
    """Seconds of the same force by arrays."""
    displacement = np.random.default_rng(0).normal(scale=0.1, size=(problem.chains, problem.beads))

    def work() -> None:
        for _ in range(times):
            motion.acceleration(problem.system, displacement)

    return seconds(work) / times


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

RATE, GROWTH = 40.0, 1.3


def collision_ratios(_root: Path) -> Iterator[Ratio]:
    """A collision beside a force at N = 2, and in chains of 100 to 100,000 rows; about 20 s."""
    busy = crowd(1_000)
    cost(busy, 1_000)  # loads the compiled loop
    pairs = [(cost(busy, EVENTS), numpy_cost(busy)) for _ in range(7)]
    yield ratio_of("a force on all 2 x 1000 beads in numpy / a collision", pairs, RATE)
    costs = costs_by_rows()
    value = statistics.median(max(each) / each[0] for each in zip(*costs.values(), strict=True))
    detail = ", ".join(f"{rows:,}: {1e6 * statistics.median(each):.2f} us" for rows, each in costs.items())
    name = f"dearest collision in up to {ROWS[-1]:,} rows / in {ROWS[0]}"
    yield make_ratio(name, value, GROWTH, detail, below=True)


def costs_by_rows(repeats: int = 5) -> dict[int, list[float]]:
    """Seconds a collision takes by the number of rows, in rounds that take every length in turn."""
    problems = {rows: [crowd(rows, seed) for seed in range(max(1, min(20, 10_000 // rows)))] for rows in ROWS}
    found: dict[int, list[float]] = {rows: [] for rows in ROWS}
    for _ in range(repeats):
        for rows, several in problems.items():
            rounds = max(1, EVENTS // (PER_ROW * rows * len(several)))
            each = [cost(problem, PER_ROW * rows) for _ in range(rounds) for problem in several]
            found[rows].append(statistics.mean(each))
    return found


def cost(problem: Problem, events: int) -> float:
    """Seconds of the processor that one collision takes, without the start, which predicts every pair once."""
    start = time.process_time()
    collisions.run(problem, max_events=0)
    middle = time.process_time()
    found = len(collisions.run(problem, max_events=events))
    end = time.process_time()
    return ((end - middle) - (middle - start)) / found


def crowd(rows: int, seed: int = 0) -> Problem:
    """Two chains in which every bead is kicked at random, theta = 1, with no end in sight."""
    random = np.random.default_rng(seed)
    velocity = random.choice([-1.0, 1.0], (2, rows)) * random.uniform(0.2, 1.0, (2, rows))
    velocity /= np.abs(velocity).max()
    kicks = tuple((chain + 1, row + 1, float(velocity[chain, row])) for row in range(rows) for chain in range(2))
    scale = Scale(1.0, 1.0, 1.0, si=False)
    return Problem(
        name="crowd",
        system=System(chains=2, beads=rows, kicks=kicks, links=coupled_chains(2, 0.5, 1.0)),
        timestep=1e6,
        steps_per_frame=1,
        frames=1,
        recorded=None,
        scale=scale,
    )
