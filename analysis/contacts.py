"""The largest overlap of contacts that the frames of a run show."""

import math

import numpy as np

from analysis import motion
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, laws, physics

FARTHEST = 0.25
"""Time between frames, in units of T, up to which they show the largest overlap to two per cent.

An overlap d falls by at most ``d**1.5 t**2`` in a time t from its maximum, for no contact is opposed by more than its
own force on two beads; springs apart, which pull by little at that moment. Frames are half of this away at most.
Stiff contacts of light beads are over sooner, by the square root of ``mass / strength``.
"""


def shown_by_frames(problem: Problem) -> bool:
    """Whether the frames hold neighbouring beads, closely enough in time."""
    system = problem.system
    quicker = 1.0
    if not physics.one_kind(system):
        strength = max(float(np.max(laws.strength(link.law))) for link in system.along)
        quicker = min(1.0, math.sqrt(float(np.min(system.mass)) / strength))
    return problem.forces_known and problem.every <= FARTHEST * quicker * (1.0 + 1e-9)


class LargestOverlap:
    """Collects the largest overlaps in a run that is given block by block, with all beads recorded.

    Attributes:
        value: largest overlap so far, in units of L; negative where none has touched, -inf before the first frame.
        each: largest overlap of every contact so far, [chain, contact], where beads differ; else None.
        walls: largest overlap of the contacts with each wall so far, [chain], in the order of `physics.walls`.
    """

    def __init__(self) -> None:
        self.value = -math.inf
        self.each: Floats | None = None
        self.walls: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take more frames into account."""
        problem = block.problem
        system = problem.system
        walls = physics.walls(system)
        if not self.walls:
            self.walls = [np.full(problem.chains, -math.inf) for _ in walls]
        for largest, link in zip(self.walls, walls, strict=True):
            place = problem.beads - 1 if link.side > 0.0 else 0
            law = laws.at(link.law, np.arange(problem.chains), place)
            strain = np.max(link.side * block.displacement[..., place], axis=0)
            np.maximum(largest, strain - link.gap + laws.rest(law), out=largest)
        moving = slice(0, problem.beads) if physics.loaded(system) else block.moving  # beads at rest touch, or overlap
        x = block.displacement[..., moving]
        if not physics.one_kind(system) and self.each is None:
            self.each = np.full((problem.chains, problem.beads - 1), -math.inf)
        if x.shape[-1] > 1:
            overlaps = motion.overlaps(system, x, moving.start + 1)
            self.value = float(np.maximum(self.value, np.max(overlaps)))
            if self.each is not None:
                of_moving = self.each[:, moving.start : moving.start + overlaps.shape[-1]]
                np.maximum(of_moving, np.max(overlaps, axis=0), out=of_moving)
