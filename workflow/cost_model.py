"""What a run will cost in time, memory and bytes, by a model.

By a model of a step (`workflow.step_time`), with its assumptions written down: it takes a fixed time, a time for every
bead of a rank, and with more than one rank a time for the messages to the two neighbours (a rank owns whole rows, so it
sends its outermost rows only). Times and bytes a bead were measured on one core with 100 to a million beads; the time
of messages is assumed. Larger runs are extrapolated, taking for granted that

- memory and its bandwidth grow with the ranks (true for ranks on different nodes, less so for those of one);
- a network takes some microseconds a message, and the outermost rows of a rank are few beads beside its own;
- frames are written by one rank, at the speed of one file.

Plug-ins take this module to plan runs on clusters: `cost` estimates time and size of a run, `MEMORY` its memory.

Examples:
    >>> problem = granchain.load("one-chain", {"timestep": 0.01}).problem()
    >>> estimated = cost_model.cost(problem, ranks=1)
    >>> round(estimated.seconds, 3), estimated.frames  # in s and bytes
    (0.077, 4857434.0)
"""

import math
from dataclasses import dataclass

from analysis.files.dump_layout import sizes
from lammps_inputs import Problem
from workflow.step_time import MESSAGES, frame_seconds, step_seconds

MEMORY = 1000
"""Memory in bytes a bead of a single chain at the start, when it is largest; 600 to 700 for coupled chains."""


REFERENCE_FORCE = 1e-9
"""Seconds of the reference integrator for the forces on a bead; measured: 0.7e-9 to 3e-9."""


@dataclass(frozen=True)
class Cost:
    """Estimated cost of a run.

    Attributes:
        step: time of a time step without frames, in s.
        seconds: time of the run with its frames, in s.
        frame: size of a frame, in bytes.
        frames: size of all frames, in bytes.
    """

    step: float
    seconds: float
    frame: float
    frames: float


def cost(problem: Problem, ranks: int) -> Cost:
    """Estimated cost of a run, by the model.

    Args:
        problem: what is to run.
        ranks: number of MPI ranks.

    Returns:
        The cost, in s and bytes.
    """
    frame, frames = sizes(problem)
    largest = math.ceil(problem.rows / ranks) * problem.chains
    fixed, bead = step_seconds(problem)
    step = fixed + bead * largest + MESSAGES * (ranks > 1)
    return Cost(step, step * problem.steps + frame_seconds(frames, problem.frames), frame, frames)
