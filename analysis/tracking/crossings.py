"""Where a velocity may have a maximum between frames: which pairs of frames, and where its slope falls through zero.

Velocities at frames do not show every maximum: one and the minimum after it may lie between two frames, or between
three of which each is faster than the one before. So the slope of a polynomial is examined between all frames where
the velocity hardly rises, and its sign is taken for certain only where it exceeds the error of the slope.
"""

from typing import NamedTuple

import numpy as np

from analysis.trajectory import Flags, Floats, Integers

LEVEL = 0.25
"""Rise between two frames over the larger one of those before and after, or of the one after over it, up to which a
maximum may be hidden there.

A slope whose smallest value is 0, and which grows with the square of the time from there on both sides, gives a ratio
of 1/7 or less.
"""

FAINT = 0.5
"""Velocity at a frame, in that of the smallest maximum, beside which there may be such a maximum."""

SAMPLES = 17
"""Instants, with both frames, at which slopes are examined."""

SLIGHT = 1e-5
"""Loss of velocity after the start, in V, up to which a bead that then quickens has no maximum there."""


class Falls(NamedTuple):
    """Falls of slopes through zero, [fall]; places are positions among the `SAMPLES`."""

    entry: Integers
    """Position of the slope."""
    early: Integers
    """First place where the slope may have fallen to zero."""
    late: Integers
    """First place where it is certainly negative; the last one where it may have risen again."""
    certain: Flags
    """Whether it becomes negative in between."""


def candidates(velocity: Floats, threshold: float, *, everywhere: bool = False) -> tuple[tuple[Integers, ...], Flags]:
    """Pairs of consecutive frames between which a velocity may have a maximum.

    Args:
        velocity: [frame, ...]; the first and the last pair of frames are not examined.
        threshold: smallest maximum.
        everywhere: whether maxima may be hidden at any rise, as frames are far apart for the fastest motion.

    Returns:
        Positions of the pairs, [candidate], along each axis; mask, [candidate], of those whose first frame is the
        faster one.
    """
    rise = np.diff(velocity, axis=0)
    fast = (np.abs(velocity) if everywhere else velocity) > FAINT * threshold
    level, rising = LEVEL * rise, rise > 0.0
    chosen = rise[1:-1] <= np.maximum(level[:-2], level[2:])
    chosen |= rise[2:] <= level[1:-1]
    chosen &= rising[1:-1] | rising[:-2]
    chosen |= everywhere
    chosen &= fast[1:-2] | fast[2:-1]
    pairs = tuple(axis.astype(np.int64) for axis in np.nonzero(chosen))
    return pairs, ~rising[1:-1][pairs]


def falls(slope: Floats, error: Floats, change: Floats) -> Falls:
    """Falls of slopes that are known to within an error through zero, in the order of place.

    Args:
        slope: [`SAMPLES`, entry], exact at both ends.
        error: [entry]
        change: [entry] integral of the slope, exact.
    """
    sign = np.where(slope > error, 1, np.where(slope <= -error, -1, 0))
    sign[1:-1][(sign[1:-1] > 0) & (_lowest(slope) <= error)] = 0
    sign[[0, -1]] = np.where(slope[[0, -1]] > 0.0, 1, -1)
    rises = (change > 0.0) & ~np.any(sign > 0, axis=0)  # so it is positive somewhere before the last zero
    last = SAMPLES - 1 - np.argmax(sign[::-1] == 0, axis=0)
    sign[rises & (sign < 0) & (np.arange(SAMPLES)[:, np.newaxis] < last)] = 0
    sign[0][rises] = 1
    count = len(error)
    rising, early = sign[0] > 0, np.zeros(count, dtype=np.int64)
    parts = []

    def add(entries: Integers, late: int, certain: Flags) -> None:
        """Add falls of slopes at positions [fall]; ``certain`` is of all slopes, [entry]."""
        parts.append(Falls(entries, early[entries], np.full(len(entries), late), certain[entries]))

    for place in range(1, SAMPLES):
        early[rising & (early == 0) & (sign[place] <= 0)] = place
        over = rising & (sign[place] < 0)
        if np.any(over):
            add(np.flatnonzero(over), place, over)
        rising, early = (rising & ~over) | (sign[place] > 0), np.where(over, 0, early)
    add(np.flatnonzero(early), SAMPLES - 1, change <= 0.0)
    return Falls(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def starts(slope: Floats, error: Floats, rate: Floats) -> tuple[Floats, Flags, Flags]:
    """Slopes without the fall after a start that is slight, and whether velocities are largest there.

    Args:
        slope: [`SAMPLES`, entry] as in `falls`.
        error: [entry]
        rate: [entry] derivative of the slope at the start, of any unit.

    Returns:
        The slopes for `falls`; masks, [entry], of those that are largest at the start for certain, and possibly.
    """
    sign = np.where(slope > error, 1, np.where(slope <= -error, -1, 0))
    sign[0], sign[-1] = 0, np.where(slope[-1] > 0.0, 1, -1)
    places = np.arange(SAMPLES)[:, np.newaxis]
    first = np.argmax(sign != 0, axis=0)
    slows = np.take_along_axis(sign, first[np.newaxis], axis=0)[0] < 0
    before = places < first
    onset = np.where(slope[0] != 0.0, slope[0], rate)
    onset = np.where(onset == 0.0, -np.any(before & (slope < 0.0), axis=0).astype(np.float64), onset)
    quickens = (onset > 0.0) | ((slope[0] == 0.0) & (rate == 0.0) & np.any(before & (slope > 0.0), axis=0))
    since = np.where(np.any(sign > 0, axis=0), np.argmax(sign > 0, axis=0), SAMPLES)
    fall = np.where(places < since, np.maximum(error - slope, 0.0), 0.0).sum(axis=0) / (SAMPLES - 1)
    slight = (since < SAMPLES) & (fall <= SLIGHT)
    largest, perhaps = slows & ~quickens & ~slight, ~slows & (onset < 0.0) & ~slight
    rising = np.where(slight & (places < since), np.maximum(slope, 2.0 * error), slope)
    rising[0] = np.where(largest, -error, 2.0 * error)
    return rising, largest, perhaps


def _lowest(slope: Floats) -> Floats:
    """Values that slopes reach near each sample between the ends, by the parabola through it and its neighbours."""
    before, at, after = slope[:-2], slope[1:-1], slope[2:]
    bend = before - 2.0 * at + after
    lowest = (at < before) & (at <= after)
    return np.where(lowest, at - (after - before) ** 2 / (8.0 * np.where(lowest, bend, 1.0)), at)
