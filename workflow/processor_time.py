"""A limit on the processor time of what is computed before a run, on the thread that computes it.

Compilation does not count: it cannot be cut short, and happens once on a machine for each kind of scene
(`workflow.compiled`).
"""

import math
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

BEFORE_RUN = 10.0
"""Seconds that all trials before a run may take together: those for its duration, its window and its time step."""

_UNCHECKED = 1.5
"""Seconds of these that are left for what is computed between two checks, and after the last: frames, rates of laws."""


class LimitReachedError(Exception):
    """The processor time of a block under `limited` is used up."""


class _Uncounted(threading.local):
    seconds = 0.0


_uncounted = _Uncounted()
_limit: ContextVar[float] = ContextVar("limit", default=math.inf)


def clock() -> float:
    """Processor time of this thread so far without compilation, in s."""
    return time.thread_time() - _uncounted.seconds


def leave_out(seconds: float) -> None:
    """Leave some processor time of this thread out of what counts."""
    _uncounted.seconds += seconds


def left() -> float:
    """Seconds that are left in this block; infinity where nothing is limited."""
    return _limit.get() - clock()


def check() -> None:
    """Go on only within the limit; to be called often.

    Raises:
        LimitReachedError: the time of this block is used up.
    """
    if left() < 0.0:
        raise LimitReachedError


@contextmanager
def limited(seconds: float = BEFORE_RUN - _UNCHECKED) -> Iterator[None]:
    """Limit the processor time of a block; within another such block, also to what that has left."""
    token = _limit.set(min(_limit.get(), clock() + seconds))
    try:
        yield
    finally:
        _limit.reset(token)
