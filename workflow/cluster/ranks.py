"""How many ranks are worth while, and what a run will cost: a model of a step, with its assumptions written down.

A step takes a fixed time, a time for every bead of a rank, and with more than one rank a time for the messages to the
two neighbours (a rank owns whole rows, so it sends its outermost rows only). Times and bytes a bead were measured on
one core with 100 to a million beads; the time of messages is assumed. Larger runs are extrapolated, taking for granted
that

- memory and its bandwidth grow with the ranks (true for ranks on different nodes, less so for those of one);
- a network takes some microseconds a message, and the outermost rows of a rank are few beads beside its own;
- frames are written by one rank, at the speed of one file.
"""

import math
from dataclasses import dataclass

from lammps_inputs import Problem

LONE_BEAD = 10e-9
"""Seconds a bead and step without springs, of a million beads; 8 ns where they fit into the cache."""

COUPLED_BEAD = 20e-9
"""Seconds a bead and step with springs, of a million beads; 13 ns where they fit into the cache."""

STEP = 1.5e-6
"""Seconds a step at the least."""

MESSAGES = 10e-6
"""Seconds a step for the messages of a rank to its neighbours, and for waiting for them: assumed."""

MEMORY = 1000
"""Bytes a bead, at the start, when it is most: of a lone chain; 600 to 700 of coupled ones."""

PROCESS = 40_000_000
"""Bytes a rank without any bead."""

LONE_RESTART, COUPLED_RESTART = 144, 190
"""Bytes a bead in a restart."""

FILE = 5e8
"""Bytes a second into one file: assumed."""

EFFICIENCY = 0.9
"""Part of the time that a rank spends on its beads rather than on messages, below which more ranks are a waste."""

LEAST_ROWS = 20
"""Rows of a rank below which those that it shares with its neighbours are no longer few beside its own."""

RANKS_OF_A_NODE = 32
"""Where a site does not say how many cores its nodes have."""


@dataclass(frozen=True)
class Cost:
    """What a run takes.

    Attributes:
        ranks: MPI ranks.
        beads: of all chains, as far as they exist.
        step: seconds for a time step, without frames.
        seconds: for the whole run, with its frames.
        memory: bytes, of all ranks together.
        frame: bytes of a frame.
        frames: bytes of all frames.
        restart: bytes of a restart.
    """

    ranks: int
    beads: int
    step: float
    seconds: float
    memory: float
    frame: float
    frames: float
    restart: float

    def sentence(self) -> str:
        """All of it in one line."""
        ranks = f"{self.ranks} rank{'s' * (self.ranks > 1)} of {math.ceil(self.beads / self.ranks)} beads"
        return (
            f"{ranks}: about {_duration(self.seconds)} ({_duration(self.step)} a step), "
            f"{_bytes(self.memory)} of memory, "
            f"{_bytes(self.frames)} of frames ({_bytes(self.frame)} each), {_bytes(self.restart)} a restart"
        )


def bead_seconds(problem: Problem) -> float:
    """Seconds a bead and step."""
    return COUPLED_BEAD if problem.coupled else LONE_BEAD


def least_beads(problem: Problem) -> int:
    """Beads that a rank must have to be worth its messages."""
    return math.ceil(EFFICIENCY / (1.0 - EFFICIENCY) * MESSAGES / bead_seconds(problem))


def advised(problem: Problem, most: int) -> int:
    """Number of ranks that are worth while, at most ``most``."""
    beads = problem.chains * problem.rows
    return max(1, min(most, beads // least_beads(problem), problem.rows // LEAST_ROWS))


def cost(problem: Problem, ranks: int) -> Cost:
    """What a run takes on some ranks, by the model."""
    beads = problem.chains * problem.rows
    columns = 3 if problem.window is None else 4
    frame = 8.0 * columns * problem.chains * problem.rows_a_frame
    frames = frame * (problem.frames + 1)
    step = (
        STEP
        + bead_seconds(problem) * math.ceil(problem.rows / ranks) * problem.chains
        + (MESSAGES if ranks > 1 else 0.0)
    )
    return Cost(
        ranks=ranks,
        beads=beads,
        step=step,
        seconds=step * problem.steps + frames / FILE,
        memory=float(MEMORY * beads + PROCESS * ranks),
        frame=frame,
        frames=frames,
        restart=float((COUPLED_RESTART if problem.coupled else LONE_RESTART) * beads),
    )


def too_many(problem: Problem, ranks: int) -> str:
    """That one rank would be faster by the model, in one line; empty if it would not."""
    alone = cost(problem, 1)
    if alone.step >= cost(problem, ranks).step:
        return ""
    return f"one rank would be faster: about {_duration(alone.seconds)} with --nodes 1 --ranks-per-node 1"


_TIMES = (
    (2 * 86400.0, 86400.0, "days"),
    (7200.0, 3600.0, "h"),
    (120.0, 60.0, "min"),
    (1.0, 1.0, "s"),
    (1e-3, 1e-3, "ms"),
)
"""The least time that is told in a unit, and the unit in seconds."""


def _duration(seconds: float) -> str:
    for least, size, unit in _TIMES:
        if seconds >= least:
            return _rounded(seconds / size, unit)
    return _rounded(seconds * 1e6, "us")


def _bytes(count: float) -> str:
    for size, unit in ((1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if count >= size:
            return _rounded(count / size, unit)
    return _rounded(count, "bytes")


def _rounded(value: float, unit: str) -> str:
    return f"{value:.2g} {unit}" if value < 99.5 else f"{value:.0f} {unit}"
