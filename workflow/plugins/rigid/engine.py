"""One problem from start to end: the list of its collisions, and the motion of every bead between them.

Loop over events: detect, evolve, resolve, record. Rows count from 0 here. Pair i is rows i and i + 1; it waits in the
queue for the first contact of any of its chains.

Collisions at one instant are resolved one after the other. Exchanges in different chains concern different beads, and
within a chain they sort the velocities of the beads that touch, so the outcome depends on no order, and the number of
exchanges is finite. At a contact the springs never press: the relative acceleration of the two beads is kappa times the
distances of the neighbouring pairs in the same rows, all >= 0. So no contact lasts, and collisions do not pile up.

The queue is a binary heap of fixed members with the place of each member, so that a time changes in place.
Nothing outdated is ever kept, so its size is the number of members and nothing has to be thrown away.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granchain.parts import Floats, Problem, Trajectory, compiled, frames_per_block, physics
from workflow.plugins.rigid.modes import Modes, advance, make_modes
from workflow.plugins.rigid.roots import CONTACT, NEVER, PairDistance, first_contact

Ints = NDArray[np.int64]


class Heap(NamedTuple):
    """Times of all members, and their order."""

    time: Floats
    """time of each member, [member]"""
    member: Ints
    """member at each place, [place]; place 0 has the earliest time, and place k is not later than 2k+1 and 2k+2"""
    place: Ints
    """place of each member, [member]"""


def make_heap(members: int) -> Heap:
    """A queue whose members all wait for ever."""
    return Heap(np.full(members, np.inf), np.arange(members), np.arange(members))


@compiled.ieee
def reschedule(heap: Heap, member: int, time: float) -> None:
    """Give a member another time."""
    times, members, places = heap
    times[member] = time
    place = places[member]
    while place > 0:
        above = (place - 1) // 2
        other = members[above]
        if times[other] <= time:
            break
        members[place], places[other] = other, place
        place = above
    while True:
        below = 2 * place + 1
        if below >= len(members):
            break
        if below + 1 < len(members) and times[members[below + 1]] < times[members[below]]:
            below += 1
        other = members[below]
        if times[other] >= time:
            break
        members[place], places[other] = other, place
        place = below
    members[place], places[member] = member, place


class RowStates(NamedTuple):
    """State of every row at its own time, that of its last collision."""

    x: Floats
    """displacement [row, chain]"""
    v: Floats
    """velocity [row, chain]"""
    time: Floats
    """time of the last collision, [row]"""


class CollisionState(NamedTuple):
    """Everything that the loop changes."""

    rows: RowStates
    queue: Heap
    """queue of the pairs"""
    chain: Ints
    """chain that meets at the pair's time in the queue, or -1 to search again, [pair]"""
    near: Floats
    """work [x and v, row of the pair, chain]"""
    relative: Floats
    """work [q and p, mode]"""
    waves: Floats
    """work [a and b, mode]"""


class EventArrays(NamedTuple):
    """Arrays for consecutive collisions."""

    time: Floats
    chain: Ints
    row: Ints
    striker: Floats
    """velocity of the bead of this row before the collision, and of the other after it"""
    target: Floats
    """velocity of the bead of the next row before the collision, and of this one after it"""


def make_state(rows: RowStates, modes: Modes) -> CollisionState:
    """A state in which nothing has been predicted yet."""
    pairs, chains = len(rows.x) - 1, rows.x.shape[1]
    oscillating = len(modes.omega)
    return CollisionState(
        rows,
        make_heap(pairs),
        np.full(pairs, -1),
        np.empty((2, 2, chains)),
        np.empty((2, oscillating)),
        np.empty((2, oscillating)),
    )


@compiled.ieee_called_by_compiled
def evolve(rows: RowStates, pair: int, time: float, modes: Modes, near: Floats) -> None:
    """Write displacements and velocities of a pair of rows at a time into ``near``, [x and v, row of the pair, chain].

    The rows themselves stay as their last collision left them, so that looking at a row never adds to its rounding.
    """
    for side in range(2):
        row = pair + side
        advance(rows.x, rows.v, row, time - rows.time[row], modes, near, side)


@compiled.ieee_called_by_compiled
def resolve(rows: RowStates, pair: int, time: float, chain: int, near: Floats) -> None:
    """Set a pair of rows to ``near``, [x and v, row of the pair, chain], and exchange the velocities of one chain."""
    for side in range(2):
        rows.time[pair + side] = time
        for j in range(near.shape[2]):
            rows.x[pair + side, j], rows.v[pair + side, j] = near[0, side, j], near[1, side, j]
    rows.v[pair, chain], rows.v[pair + 1, chain] = near[1, 1, chain], near[1, 0, chain]


@compiled.ieee_called_by_compiled
def predict(state: CollisionState, pair: int, now: float, modes: Modes, gaps: Floats, end: float) -> None:
    """Put the next contact of a pair of rows, whose gaps are [pair, chain], into the queue."""
    near, relative, waves = state.near, state.relative, state.waves
    omega, shape, weight = modes.omega, modes.shape, modes.weight
    evolve(state.rows, pair, now, modes, near)
    chains, oscillating = near.shape[2], len(modes.omega)
    distance, rate = 0.0, 0.0  # of the centres of mass
    for j in range(chains):
        distance += near[0, 1, j] - near[0, 0, j]
        rate += near[1, 1, j] - near[1, 0, j]
    distance /= chains
    rate /= chains
    for m in range(oscillating):
        q, p = 0.0, 0.0
        for j in range(chains):
            q += shape[m, j] * (near[0, 1, j] - near[0, 0, j])
            p += shape[m, j] * (near[1, 1, j] - near[1, 0, j])
        relative[0, m] = q * weight[m]
        relative[1, m] = p * weight[m] / omega[m]
    limit, meeting, nearest = end - now, -1, math.inf
    for j in range(chains):
        gap = gaps[pair, j]
        g, slope = gap + (near[0, 1, j] - near[0, 0, j]), near[1, 1, j] - near[1, 0, j]
        for m in range(oscillating):
            waves[0, m] = shape[m, j] * relative[0, m]
            waves[1, m] = shape[m, j] * relative[1, m]
        free = oscillating == 0  # then every bead is its own centre of mass
        start, drift = (g, slope) if free else (gap + distance, rate)
        wait, outcome = first_contact(PairDistance(g, slope, start, drift, waves, omega), limit, now, gap)
        if outcome != NEVER:
            time = now + wait
            if time <= now and slope >= 0.0:
                time = np.nextafter(now, math.inf)  # separating beads meet later, if only by rounding
            if time < nearest:
                nearest = time
                meeting = j if outcome == CONTACT else -1
                limit = min(limit, wait)
    state.chain[pair] = meeting
    reschedule(state.queue, pair, nearest)


@compiled.ieee
def predict_all(state: CollisionState, modes: Modes, gaps: Floats, end: float) -> None:
    """Predict every pair from time 0, at gaps [pair, chain]."""
    for pair in range(len(state.chain)):
        predict(state, pair, 0.0, modes, gaps, end)


@compiled.ieee
def collide(state: CollisionState, modes: Modes, gaps: Floats, end: float, events: EventArrays) -> int:
    """Run until arrays of events are full or nothing meets, at gaps [pair, chain]; the number of recorded events."""
    rows, queue, near = state.rows, state.queue, state.near
    count = 0
    while count < len(events.time):
        pair = queue.member[0]  # detect
        time, chain = queue.time[pair], state.chain[pair]
        if time > end:
            break
        first, last = pair, pair
        if chain >= 0:
            evolve(rows, pair, time, modes, near)  # evolve
            striker, target = near[1, 0, chain], near[1, 1, chain]
            if striker > target:  # no graze within rounding
                resolve(rows, pair, time, chain, near)  # resolve
                events.time[count], events.chain[count], events.row[count] = time, chain, pair  # record
                events.striker[count], events.target[count] = striker, target
                count += 1
                first, last = max(pair - 1, 0), min(pair + 1, len(state.chain) - 1)
        for touched in range(first, last + 1):
            predict(state, touched, time, modes, gaps, end)
    return count


# --- runs -------------------------------------------------------------------------------------------------------------

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
        """Momentum transferred in each collision, [collision], in units of m V; above 0."""
        return self.striker - self.target


def run(problem: Problem, *, max_events: int | None = None) -> CollisionRun:
    """All collisions of rigid beads until the problem's duration, or the first of them.

    Args:
        problem: beads of mass 1 with gaps, in chains that are coupled the same in each; its contact law, time step and
            recorded beads play no part.
        max_events: stop after so many collisions.

    Raises:
        ValueError: the beads touch at the start.
    """
    end, shape = problem.duration, (problem.chains, problem.beads - 1)
    gaps = np.ascontiguousarray(np.broadcast_to(problem.system.along[0].gap, shape).T)  # [pair, chain]
    if not np.all(gaps > 0.0):
        raise ValueError(
            "gap: rigid beads that touch have no order of collisions; the engine `collisions` needs a gap > 0"
        )
    rows, modes = _start(problem)
    state = make_state(rows, modes)
    predict_all(state, modes, gaps, end)
    parts = []
    count = 0
    while True:
        room = ROOM if max_events is None else min(ROOM, max_events - count)
        events = EventArrays(*(np.empty(room, kind) for kind in (float, np.int64, np.int64, float, float)))
        recorded = collide(state, modes, gaps, end, events)
        parts.append([column[:recorded] for column in events])
        count += recorded
        if recorded < room or count == max_events:
            break
    time, chain, row, striker, target = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    until = end if recorded < room else min(end, float(time[-1]) if count else 0.0)
    return CollisionRun(problem, time, chain + 1, row + 1, striker, target, until)


def sample(run: CollisionRun, times: Floats) -> Trajectory:
    """The recorded beads at any times [frame], in units of T and in any order, from the exact motion.

    At the instant of a collision the velocities are those after it.

    Raises:
        ValueError: a time is outside the run.
    """
    times = np.asarray(times, dtype=np.float64)
    if not np.all((times >= 0.0) & (times <= run.until)):
        raise ValueError(f"times: the run is known from 0 to {run.until!r}; sample it there")
    order = np.argsort(times, kind="stable")
    back = np.argsort(order)
    (sampled,) = played_back(run, times[order], max(1, len(times)))
    return Trajectory(run.problem, times, sampled.displacement[back], sampled.velocity[back])


def blocks(run: CollisionRun) -> Iterator[Trajectory]:
    """The problem's own frames, as far as the run is known, in consecutive blocks of bounded size."""
    times = run.problem.every * np.arange(run.problem.frames + 1, dtype=np.float64)
    return played_back(run, times[times <= run.until], frames_per_block(run.problem))


def played_back(run: CollisionRun, times: Floats, size: int) -> Iterator[Trajectory]:
    """Frames at ascending times, by playing back the collisions once; nothing is searched.

    Args:
        run: the collisions.
        times: [frame] in units of T.
        size: frames of a block.

    Returns:
        Blocks of frames, displacement and velocity [frame, chain, recorded bead] each.
    """
    problem, recorded = run.problem, run.problem.rows.numbers
    rows, modes = _start(problem)
    events, event = (run.time, run.chain - 1, run.row - 1), 0
    for first in range(0, max(1, len(times)), size):
        frames = times[first : first + size]
        displacement, velocity = np.empty((2, len(frames), problem.chains, len(recorded)))
        event = _replay(rows, modes, events, event, frames, recorded - 1, (displacement, velocity))
        yield Trajectory(problem, frames, displacement, velocity)


def _start(problem: Problem) -> tuple[RowStates, Modes]:
    """Rows at time 0, and the modes of each."""
    velocity = np.array(physics.initial_velocity(problem.system).T, order="C")
    rows = RowStates(np.zeros_like(velocity), velocity, np.zeros(len(velocity)))
    return rows, make_modes(problem.chains, physics.kappa(problem.system))


@compiled.ieee
def _replay(
    rows: RowStates,
    modes: Modes,
    events: tuple[Floats, Ints, Ints],
    event: int,
    times: Floats,
    recorded: Ints,
    outputs: tuple[Floats, Floats],
) -> int:
    """Fill displacement and velocity, [frame, chain, bead], at ascending times, with the arithmetic of the event loop.

    Rows are as the collisions before ``event`` left them, and are carried on; returns the first collision after.
    """
    time, chain, row = events
    displacement, velocity = outputs
    near = np.empty((2, 2, rows.x.shape[1]))
    for frame in range(len(times)):
        while event < len(time) and time[event] <= times[frame]:
            evolve(rows, row[event], time[event], modes, near)
            resolve(rows, row[event], time[event], chain[event], near)
            event += 1
        for place, bead in enumerate(recorded):
            advance(rows.x, rows.v, bead, times[frame] - rows.time[bead], modes, near, 0)
            for j in range(near.shape[2]):
                displacement[frame, j, place], velocity[frame, j, place] = near[0, 0, j], near[1, 0, j]
    return event
