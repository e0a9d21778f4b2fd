"""A queue of fixed members by time: a binary heap that knows where each member stands, so that a time changes in place.

Nothing outdated is ever kept, so its size is the number of members and nothing has to be thrown away.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.trajectory import Floats
from workflow.engines.collisions.compiled import compiled

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


@compiled
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
