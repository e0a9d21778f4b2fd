"""The reference integrator against scipy's, and the cost of one of its forces."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem
from workflow.engines.reference import engine
from workflow.engines.reference.blanes_moan import BLANES_MOAN
from workflow.engines.reference.certify import certified
from workflow.studies.bench.against_usual_ways import paper_scene, seconds
from workflow.studies.bench.ratio import Ratio, make_ratio


def reference_against_scipy() -> Iterator[Ratio]:
    """Work at an error of 1e-6 in all velocities at the end, and the cost of a force."""
    problem = paper_scene().problem()
    truth = certified(problem, 1e-9)
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
    yield make_ratio("scipy DOP853 / reference at an error of 1e-6", [b / a for a, b in pairs], 100.0, times=pairs)
    steps = 8 * problem.frames
    costs = [(kernel_cost(ends, steps), numpy_cost(problem)) for _ in range(7)]
    yield make_ratio("a force in numpy / in the kernel", [b / a for a, b in costs], 50.0, times=costs)


def kernel_cost(problem: Problem, steps: int) -> float:
    """Seconds a force evaluation of all beads, all rows integrated from the start to the one frame."""
    hit_at_both_ends = replace(problem, kicks=((1, 1, 1.0), (1, problem.beads, -1e-3)))
    took = seconds(lambda: engine.run(hit_at_both_ends, steps_per_frame=steps))
    return took / (steps * BLANES_MOAN.forces_per_step)


def numpy_cost(problem: Problem, times: int = 2000) -> float:
    """Seconds of the same force by arrays."""
    displacement = np.random.default_rng(0).normal(scale=0.1, size=(problem.chains, problem.beads))

    def work() -> None:
        for _ in range(times):
            motion.acceleration(problem, displacement)

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
        acceleration = motion.acceleration(problem, state[:count].reshape(shape))
        return np.concatenate([state[count:], acceleration.ravel()])

    start = np.concatenate([np.zeros(count), problem.initial_velocity().ravel()])
    span = (0.0, problem.duration)
    found = solve_ivp(slope, span, start, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=span[1:])
    return np.asarray(found.y[count:, -1].reshape(shape))
