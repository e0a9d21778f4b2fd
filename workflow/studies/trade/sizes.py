"""What a Verlet step costs in LAMMPS by the number of beads, on its own and as a part of suzuki4's cycles."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import get_args

from lammps_inputs import Problem
from lammps_inputs import scheme as schemes
from lammps_inputs.scheme import SchemeName
from workflow.studies.trade import jobs

FACTORS = (1, 10, 100)
MOST_ATOMS = 50_000

BEAD_SECONDS = 2e-8
STEP_SECONDS = 5e-6
"""Of a step: guesses from which the number of steps that are timed follows."""

SECONDS = 0.4
"""Of a timed run."""

LEAST_CYCLES = 40

ROUNDS = 2


@dataclass(frozen=True)
class Size:
    """Seconds that a Verlet step takes, by scheme, of so many atoms."""

    atoms: int
    seconds: dict[str, float]


def measure(problem: Problem, directory: Path) -> Sequence[Size]:
    """The scene's chains as they are and longer, without frames.

    Raises:
        RunError: LAMMPS failed.
    """
    found = []
    for factor in FACTORS:
        longer = replace(problem, beads=problem.beads * factor, recorded=None, window=None)
        atoms = longer.chains * longer.beads
        if factor == 1 or (atoms <= MOST_ATOMS and problem.uniform):
            found.append(Size(atoms, _seconds(longer, directory)))
    return found


def _seconds(problem: Problem, directory: Path) -> dict[str, float]:
    """By the difference of a long and a very short run, which the setup drops out of; the best of some rounds."""
    stages = schemes.cycle("suzuki4")
    guess = STEP_SECONDS + BEAD_SECONDS * problem.chains * problem.beads
    counts = (stages, stages * max(LEAST_CYCLES, int(SECONDS / guess / stages)))
    best: dict[tuple[str, int], float] = {}
    for _ in range(ROUNDS):
        for name in get_args(SchemeName):
            for steps in counts:
                bare = replace(problem, scheme=name, steps_per_frame=steps, frames=1)
                took, _ = jobs.lammps(bare, directory)
                best[name, steps] = min(took, best.get((name, steps), took))
    few, many = counts
    # however noisy the machine, a setup never takes more than half of the long run
    return {
        name: max(best[name, many] - best[name, few], 0.5 * best[name, many]) / (many - few)
        for name in get_args(SchemeName)
    }
