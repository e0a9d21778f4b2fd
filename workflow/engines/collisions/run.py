"""One problem from start to end: the list of its collisions, and the motion of every bead between them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analysis.trajectory import Floats, Trajectory, frames_per_block
from lammps_inputs import Problem, physics
from workflow.compiled import ieee
from workflow.engines.collisions.engine import (
    Ints,
    Rows,
    collide,
    evolve,
    make_events,
    make_rows,
    make_state,
    predict_all,
    resolve,
)
from workflow.engines.collisions.modes import Modes, advance, make_modes

ROOM = 1 << 16
"""Collisions between two returns to Python, where a run can be interrupted."""


@dataclass(frozen=True)
class CollisionRun:
    """Every collision of a run in the order in which they happen; the motion between them follows exactly.

    Bead ``row`` of a chain strikes bead ``row + 1``; the two exchange ``striker`` and ``target``.

    Attributes:
        problem: what was computed.
        time: [collision], in units of T.
        chain: [collision], counted from 1.
        row: [collision], number of the bead that strikes, counted from 1.
        striker: [collision], its velocity before, and that of the bead it strikes after, in units of V.
        target: [collision], the velocity of the bead it strikes before, and its own after.
        until: time up to which the run is known.
    """

    problem: Problem
    time: Floats
    chain: Ints
    row: Ints
    striker: Floats
    target: Floats
    until: float

    def __len__(self) -> int:
        """Number of collisions."""
        return len(self.time)

    @property
    def impulse(self) -> Floats:
        """[collision] momentum handed on (> 0)."""
        return self.striker - self.target


def run(problem: Problem, *, max_events: int | None = None) -> CollisionRun:
    """All collisions of rigid beads until the problem's duration, or the first of them.

    Args:
        problem: beads of mass 1 a gap apart; its contact law, time step and recorded beads play no part.
        max_events: stop after so many collisions.

    Raises:
        ValueError: the beads touch at the start.
    """
    system = problem.system
    if not physics.gap(system) > 0.0:
        raise ValueError(
            "gap: rigid beads that touch have no order of collisions; the engine `collisions` needs a gap > 0"
        )
    modes = make_modes(problem.chains, physics.kappa(system))
    state = make_state(_start(problem), modes)
    end = problem.duration
    predict_all(state, modes, physics.gap(system), end)
    parts = []
    count = 0
    while True:
        room = ROOM if max_events is None else min(ROOM, max_events - count)
        events = make_events(room)
        found = collide(state, modes, physics.gap(system), end, events)
        parts.append([column[:found] for column in events])
        count += found
        if found < room or count == max_events:
            break
    time, chain, row, striker, target = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    until = end if found < room else min(end, float(time[-1]) if count else 0.0)
    return CollisionRun(problem, time, chain + 1, row + 1, striker, target, until)


def sample(run: CollisionRun, times: Floats) -> Trajectory:
    """The recorded beads at any times [frame], in any order, from the exact motion.

    At the instant of a collision the velocities are those after it. The collisions are played back once; nothing is
    searched and nothing but the frames is stored.

    Raises:
        ValueError: a time is outside the run.
    """
    times = np.asarray(times, dtype=np.float64)
    if not np.all((times >= 0.0) & (times <= run.until)):
        raise ValueError(f"times: the run is known from 0 to {run.until!r}; sample it there")
    problem = run.problem
    order = np.argsort(times, kind="stable")
    recorded = problem.recorded_beads
    displacement, velocity = np.empty((2, len(times), problem.chains, len(recorded)))
    modes = make_modes(problem.chains, physics.kappa(problem.system))
    chain, row = run.chain - 1, run.row - 1
    _replay(_start(problem), 0, run.time, chain, row, modes, times, order, recorded - 1, displacement, velocity)
    return Trajectory(problem, times, displacement, velocity)


def blocks(run: CollisionRun) -> Iterator[Trajectory]:
    """The frames of `trajectory` in consecutive blocks of bounded size."""
    problem = run.problem
    times = problem.every * np.arange(problem.frames + 1, dtype=np.float64)
    times = times[times <= run.until]
    modes = make_modes(problem.chains, physics.kappa(problem.system))
    rows, event, chain, row = _start(problem), 0, run.chain - 1, run.row - 1
    recorded = problem.recorded_beads
    size = frames_per_block(problem)
    for first in range(0, len(times), size):
        frames = times[first : first + size]
        displacement, velocity = np.empty((2, len(frames), problem.chains, len(recorded)))
        order = np.arange(len(frames))
        event = _replay(rows, event, run.time, chain, row, modes, frames, order, recorded - 1, displacement, velocity)
        yield Trajectory(problem, frames, displacement, velocity)


def trajectory(run: CollisionRun) -> Trajectory:
    """The problem's own frames, ``every * (0, 1, ... frames)``, as far as the run is known."""
    times = run.problem.every * np.arange(run.problem.frames + 1, dtype=np.float64)
    return sample(run, times[times <= run.until])


def _start(problem: Problem) -> Rows:
    velocity = physics.initial_velocity(problem.system).T
    return make_rows(np.zeros_like(velocity), velocity)


@ieee
def _replay(
    rows: Rows,
    event: int,
    time: Floats,
    chain: Ints,
    row: Ints,
    modes: Modes,
    frames: Floats,
    order: Ints,
    recorded: Ints,
    displacement: Floats,
    velocity: Floats,
) -> int:
    """Fill in the frames, whose times ascend in this order, with the arithmetic of the engine itself.

    Rows are as the collisions before ``event`` left them, and are carried on; returns the first collision after.
    """
    chains = rows.x.shape[1]
    near = np.empty((2, 2, chains))
    for frame in order:
        while event < len(time) and time[event] <= frames[frame]:
            evolve(rows, row[event], time[event], modes, near)
            resolve(rows, row[event], time[event], chain[event], near)
            event += 1
        for place, bead in enumerate(recorded):
            advance(rows.x, rows.v, bead, frames[frame] - rows.time[bead], modes, near, 0)
            displacement[frame, :, place], velocity[frame, :, place] = near[0, 0], near[1, 0]
    return event
