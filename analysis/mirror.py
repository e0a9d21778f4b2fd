"""A run seen in a mirror across the chains: a pulse that runs towards bead 1 becomes one that runs away from it.

The equations do not change: the last bead becomes bead 1, and displacements and velocities change their sign.
"""

from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Trajectory
from lammps_inputs import Problem

Number = TypeVar("Number", int, NDArray[np.int64])


def direction_of(problem: Problem) -> int:
    """Which way the hardest blow goes, and so the leading pulse: 1 towards higher bead numbers, -1 towards lower."""
    _, _, hardest = problem.hardest_blow
    return 1 if hardest > 0.0 else -1


def mirrored_bead(problem: Problem, bead: Number) -> Number:
    """Number of a bead in the mirror; twice is the bead itself."""
    return problem.beads + 1 - bead


def along_the_way(problem: Problem, bead: Number) -> Number:
    """Number of a bead counted along the leading pulse's way: its own, or that in the mirror."""
    return bead if direction_of(problem) > 0 else mirrored_bead(problem, bead)


def mirrored_problem(problem: Problem) -> Problem:
    """The problem in the mirror; twice is the problem itself."""
    recorded = problem.recorded
    return replace(
        problem,
        kicks=tuple((chain, mirrored_bead(problem, bead), -velocity) for chain, bead, velocity in problem.kicks),
        links=tuple(link.mirrored() for link in problem.links),
        dampers=tuple(link.mirrored() for link in problem.dampers),
        mass=problem.mass_of(Ellipsis, slice(None, None, -1)),
        loads=tuple(load.mirrored(mirrored_bead(problem, load.bead)) for load in problem.loads),
        motions=tuple(motion.mirrored(mirrored_bead(problem, motion.bead)) for motion in problem.motions),
        recorded=None if recorded is None else tuple(mirrored_bead(problem, bead) for bead in reversed(recorded)),
    )


def mirrored(block: Trajectory) -> Trajectory:
    """Frames in the mirror; twice is the frames themselves."""
    return Trajectory(
        mirrored_problem(block.problem),
        block.time,
        -block.displacement[..., ::-1],
        -block.velocity[..., ::-1],
        first=1 if block.problem.window is None else mirrored_bead(block.problem, int(block.beads[-1])),
    )
