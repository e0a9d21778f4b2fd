"""The largest overlap of neighbouring beads that the frames of a run show."""

import math

import numpy as np

from analysis import motion
from analysis.trajectory import Trajectory
from lammps_inputs import Problem

FARTHEST = 0.25
"""Time between frames, in units of T, up to which they show the largest overlap to two per cent.

An overlap d falls by at most ``d**1.5 t**2`` in a time t from its maximum, for no contact is opposed by more than its
own force on two beads; springs apart, which pull by little at that moment. Frames are half of this away at most.
"""


def shown_by_frames(problem: Problem) -> bool:
    """Whether the frames hold neighbouring beads, closely enough in time."""
    return problem.recorded is None and problem.every <= FARTHEST * (1.0 + 1e-9)


class LargestOverlap:
    """Collects over the frames of a run, all beads recorded, given block by block.

    Attributes:
        value: largest overlap so far, in units of L; negative where none has touched, -inf before the first frame.
    """

    def __init__(self) -> None:
        self.value = -math.inf

    def add(self, block: Trajectory) -> None:
        """Take more frames into account."""
        x = block.displacement if block.problem.loaded else block.displacement[..., block.moving]
        if x.shape[-1] > 1:
            self.value = float(np.maximum(self.value, np.max(motion.overlaps(block.problem, x))))
