"""A run seen in a mirror across the chains: a pulse that runs towards bead 1 becomes one that runs away from it.

The equations do not change: the last bead becomes bead 1, and displacements and velocities change their sign.
"""

from dataclasses import replace
from typing import TypeVar

from analysis.trajectory import Integers, Trajectory
from lammps_inputs import Problem, physics

Number = TypeVar("Number", int, Integers)


def direction_of(problem: Problem) -> int:
    """Direction of the largest excitation and the leading pulse: 1 towards higher bead numbers, -1 towards lower."""
    _, _, excitation = physics.largest_excitation(problem.system)
    return 1 if excitation > 0.0 else -1


def mirrored_bead(problem: Problem, bead: Number) -> Number:
    """Number of a bead in the mirror; twice is the bead itself."""
    return problem.beads + 1 - bead


def along_the_way(problem: Problem, bead: Number) -> Number:
    """Number of a bead counted along the leading pulse's way: its own, or that in the mirror."""
    return bead if direction_of(problem) > 0 else mirrored_bead(problem, bead)


def mirrored_problem(problem: Problem) -> Problem:
    """The problem in the mirror; twice is the problem itself."""
    system = problem.system
    recorded = problem.recorded
    return replace(
        problem,
        system=replace(
            system,
            kicks=tuple((chain, mirrored_bead(problem, bead), -velocity) for chain, bead, velocity in system.kicks),
            links=tuple(link.mirrored() for link in system.links),
            dampers=tuple(link.mirrored() for link in system.dampers),
            mass=physics.mass_of(system, Ellipsis, slice(None, None, -1)),
            inner_mass=None if system.inner_mass is None else system.inner_mass[:, ::-1],
            inner_links=tuple(link.mirrored() for link in system.inner_links),
            loads=tuple(load.mirrored(mirrored_bead(problem, load.bead)) for load in system.loads),
            motions=tuple(motion.mirrored(mirrored_bead(problem, motion.bead)) for motion in system.motions),
        ),
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
        inner=None if block.inner is None else -block.inner[..., ::-1],
    )
