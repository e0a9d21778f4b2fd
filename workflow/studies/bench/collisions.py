"""The collision engine on this machine: a collision beside a force, and whether it costs the same in a long chain."""

import statistics
import time
from collections.abc import Iterator

import numpy as np

from lammps_inputs import Problem
from lammps_inputs.ingredients import coupled_chains
from lammps_inputs.units import Scale
from workflow.engines import collisions
from workflow.studies.bench.ratio import Ratio, make_ratio
from workflow.studies.bench.reference import numpy_cost

EVENTS = 100_000
ROWS = (100, 1_000, 10_000, 100_000)
PER_ROW = 3
"""Collisions of one row that are timed: the same early part of the motion whatever the length."""

RATE, GROWTH = 40.0, 1.3


def collision_ratios() -> Iterator[Ratio]:
    """A collision beside a force at N = 2, and in chains of 100 to 100,000 rows; about 20 s."""
    busy = crowd(1_000)
    cost(busy, 1_000)  # loads the compiled loop
    pairs = [(cost(busy, EVENTS), numpy_cost(busy)) for _ in range(7)]
    yield make_ratio(
        "a force on all 2 x 1000 beads in numpy / a collision", [b / a for a, b in pairs], RATE, times=pairs
    )
    costs = costs_by_rows()
    value = statistics.median(max(each) / each[0] for each in zip(*costs.values(), strict=True))
    detail = ", ".join(f"{rows:,}: {1e6 * statistics.median(each):.2f} us" for rows, each in costs.items())
    yield Ratio(
        f"dearest collision in up to {ROWS[-1]:,} rows / in {ROWS[0]}", value, f"<= {GROWTH}", value <= GROWTH, detail
    )


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
        chains=2,
        beads=rows,
        kicks=kicks,
        links=coupled_chains(2, 0.5, 1.0),
        timestep=1e6,
        steps_per_frame=1,
        frames=1,
        recorded=None,
        scale=scale,
    )
