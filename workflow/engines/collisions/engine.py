"""The event loop: detect, evolve, resolve, record.

Rows count from 0 here. Pair i is rows i and i + 1; it waits in the queue for the first contact of any of its chains.

Collisions at one instant are resolved one after the other. Exchanges in different chains concern different beads, and
within a chain they sort the velocities of the beads that touch, so the outcome depends on no order, and the number of
exchanges is finite. At a contact the springs never press: the relative acceleration of the two beads is kappa times the
distances of the neighbouring pairs in the same rows, all >= 0. So no contact lasts, and collisions do not pile up.

The queue is a binary heap of fixed members with the place of each member, so that a time changes in place.
Nothing outdated is ever kept, so its size is the number of members and nothing has to be thrown away.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats
from workflow.compiled import ieee, ieee_inner
from workflow.engines.collisions.modes import Modes, advance
from workflow.engines.collisions.roots import CONTACT, NEVER, first_contact

Ints = NDArray[np.int64]


class Heap(NamedTuple):
    """Times of all members, and their order."""

    time: Floats
    """[member]"""
    member: Ints
    """[place]; place 0 has the earliest time, and place k is not later than places 2k+1 and 2k+2"""
    place: Ints
    """[member]"""


def make_heap(members: int) -> Heap:
    """A queue whose members all wait for ever."""
    return Heap(np.full(members, np.inf), np.arange(members), np.arange(members))


@ieee
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


class Rows(NamedTuple):
    """State of every row at its own time, that of its last collision."""

    x: Floats
    """displacement [row, chain]"""
    v: Floats
    """velocity [row, chain]"""
    time: Floats
    """[row]"""


class State(NamedTuple):
    """Everything that the loop changes."""

    rows: Rows
    queue: Heap
    """of pairs"""
    chain: Ints
    """[pair]: the chain that meets at the pair's time in the queue, or -1 to look again"""
    near: Floats
    """work [x and v, row of the pair, chain]"""
    relative: Floats
    """work [q and p, mode]"""
    waves: Floats
    """work [a and b, mode]"""


class Events(NamedTuple):
    """Arrays for consecutive collisions."""

    time: Floats
    chain: Ints
    row: Ints
    striker: Floats
    """velocity of the bead of this row before the collision, and of the other after it"""
    target: Floats
    """velocity of the bead of the next row before the collision, and of this one after it"""


def make_rows(x: Floats, v: Floats) -> Rows:
    """Rows [row, chain] at time 0."""
    return Rows(np.array(x, order="C"), np.array(v, order="C"), np.zeros(len(x)))


def make_state(rows: Rows, modes: Modes) -> State:
    """A state in which nothing has been predicted yet."""
    pairs, chains = len(rows.x) - 1, rows.x.shape[1]
    oscillating = len(modes.omega)
    return State(
        rows,
        make_heap(pairs),
        np.full(pairs, -1),
        np.empty((2, 2, chains)),
        np.empty((2, oscillating)),
        np.empty((2, oscillating)),
    )


def make_events(size: int) -> Events:
    """Empty arrays."""
    return Events(np.empty(size), np.empty(size, np.int64), np.empty(size, np.int64), np.empty(size), np.empty(size))


@ieee_inner
def evolve(rows: Rows, pair: int, time: float, modes: Modes, near: Floats) -> None:
    """Write displacements and velocities of a pair of rows at a time into ``near``, [x and v, row of the pair, chain].

    The rows themselves stay as their last collision left them, so that looking at a row never adds to its rounding.
    """
    for side in range(2):
        row = pair + side
        advance(rows.x, rows.v, row, time - rows.time[row], modes, near, side)


@ieee_inner
def resolve(rows: Rows, pair: int, time: float, chain: int, near: Floats) -> None:
    """Put a pair of rows where `evolve` saw it and exchange the velocities of the two beads that meet."""
    for side in range(2):
        rows.time[pair + side] = time
        for j in range(near.shape[2]):
            rows.x[pair + side, j], rows.v[pair + side, j] = near[0, side, j], near[1, side, j]
    rows.v[pair, chain], rows.v[pair + 1, chain] = near[1, 1, chain], near[1, 0, chain]


@ieee_inner
def predict(state: State, pair: int, now: float, modes: Modes, gap: float, end: float) -> None:
    """Put a pair's next contact into the queue."""
    near, relative, waves = state.near, state.relative, state.waves
    omega, shape, weight = modes.omega, modes.shape, modes.weight
    evolve(state.rows, pair, now, modes, near)
    chains, oscillating = near.shape[2], len(modes.omega)
    distance, rate = 0.0, 0.0  # of the centres of mass
    for j in range(chains):
        distance += near[0, 1, j] - near[0, 0, j]
        rate += near[1, 1, j] - near[1, 0, j]
    distance = gap + distance / chains
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
        g, slope = gap + (near[0, 1, j] - near[0, 0, j]), near[1, 1, j] - near[1, 0, j]
        for m in range(oscillating):
            waves[0, m] = shape[m, j] * relative[0, m]
            waves[1, m] = shape[m, j] * relative[1, m]
        free = oscillating == 0  # then every bead is its own centre of mass
        start, drift = (g, slope) if free else (distance, rate)
        wait, outcome = first_contact(g, slope, start, drift, waves, omega, limit, now, gap)
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


@ieee
def predict_all(state: State, modes: Modes, gap: float, end: float) -> None:
    """Predict every pair from time 0."""
    for pair in range(len(state.chain)):
        predict(state, pair, 0.0, modes, gap, end)


@ieee
def collide(state: State, modes: Modes, gap: float, end: float, events: Events) -> int:
    """Run until the arrays of events are full or nothing meets before the end; the number of events recorded."""
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
            predict(state, touched, time, modes, gap, end)
    return count
