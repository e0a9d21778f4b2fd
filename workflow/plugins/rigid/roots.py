"""When two beads meet: the first root of their distance, found from bounds on the motion so that none is missed.

The distance of two neighbours of one chain is ::

    g(t) = start + drift t + sum over modes of (a cos(omega t) + b sin(omega t))

where |g - start - drift t| <= A = sum r, |g''| <= B = sum r omega^2 and |g'''| <= C = sum r omega^3, r = hypot(a, b).
From any time with g >= 0 two parabolas lie below the distance: ``g + g' s - B s^2 / 2`` always, and
``g + g' s - (C h - g'') s^2 / 2`` for s <= h. Up to the root of either, nothing can meet. Steps to that root never pass
a contact, and approach one quadratically, from before it.

What counts: a contact is ``g <= 0`` while closing (g' < 0). Touching without closing exchanges nothing. In doubles a
dip to zero within rounding may count either way; the velocities exchanged then differ by about sqrt(rounding), 1e-8.
"""

import math
from typing import NamedTuple

import numpy as np

from granchain.parts import Floats, compiled

EPS = float(np.finfo(np.float64).eps)

BUDGET = 200
"""Steps of one search: several tens of periods. Beyond them the caller looks again when the time has come."""

CONTACT, LOOK_AGAIN, NEVER = 0, 1, 2


class PairDistance(NamedTuple):
    """Distance of two neighbours of one chain from now on, in units of L and T."""

    g: float
    """distance now, as the beads' own displacements give it; an overlap is rounding and counts as touching"""
    slope: float
    """rate of the distance, as the beads' own velocities give it: its sign is exact after an exchange"""
    start: float
    """constant term"""
    drift: float
    """linear term"""
    waves: Floats
    """amplitudes of the oscillating terms, [a and b, mode]"""
    omega: Floats
    """frequencies of the oscillating terms, [mode]"""


@compiled.ieee_called_by_compiled
def advance_to(g: float, slope: float, bend: float) -> float:
    """The first positive root of ``g + slope s - bend s**2 / 2`` for g, bend >= 0; inf if there is none."""
    root = math.sqrt(slope * slope + 2.0 * bend * g)
    if slope < 0.0:
        return 2.0 * g / (root - slope)
    return (slope + root) / bend if bend > 0.0 else math.inf


@compiled.ieee_called_by_compiled
def safe_step(
    g: float, slope: float, curvature: float, bounds: tuple[float, float], least: float, limit: float
) -> float:
    """A time in which a distance g >= 0 cannot close, as long as these bounds allow.

    Args:
        g: distance now.
        slope: its rate.
        curvature: its second derivative.
        bounds: bounds on the second and third derivative at any time.
        least: the smallest step where the distance is not closing.
        limit: time from now beyond which nothing matters.
    """
    step = advance_to(g, slope, bounds[0])
    if slope >= 0.0:
        step = max(step, least)
    while step < limit:
        ahead = 2.0 * step
        proven = advance_to(g, slope, max(bounds[1] * ahead - curvature, 0.0))
        if proven <= ahead:
            return max(step, proven)
        step = ahead
    return step


@compiled.ieee
def first_contact(distance: PairDistance, limit: float, now: float, gap: float) -> tuple[float, int]:
    """Time from now until a distance closes, and CONTACT; or LOOK_AGAIN and a time before which it does not; or NEVER.

    Args:
        distance: of the two beads.
        limit: finite time from now, beyond which nothing matters.
        now: the time on the clock, whose rounding limits how finely contacts are distinguished.
        gap: initial distance; a dip below zero within 4 roundings of it need not be seen.
    """
    g, slope, start, drift, waves, omega = distance
    if g <= 0.0:
        if slope < 0.0:
            return 0.0, CONTACT
        start -= g
        g = 0.0
    amplitude, second, third, curvature = 0.0, 0.0, 0.0, 0.0
    for m in range(len(omega)):
        r = math.hypot(waves[0, m], waves[1, m])
        curvature -= waves[0, m] * omega[m] ** 2
        amplitude += r
        second += r * omega[m] ** 2
        third += r * omega[m] ** 3
    if start + min(drift, 0.0) * limit >= amplitude:
        return math.inf, NEVER
    least = math.sqrt(8.0 * EPS * gap / second)  # in this time g >= 0 that does not close falls by 4 EPS gap at most
    if start > amplitude:
        t = (amplitude - start) / drift
    else:
        t = safe_step(g, slope, curvature, (second, third), least, limit)
        if slope < 0.0 and t <= EPS * now:
            return 0.0, CONTACT
    for _ in range(BUDGET):
        if t > limit or (drift >= 0.0 and start + drift * t >= amplitude):
            return math.inf, NEVER
        g, slope, curvature = start + drift * t, drift, 0.0
        for m in range(len(omega)):
            cos, sin = math.cos(omega[m] * t), math.sin(omega[m] * t)
            wave = waves[0, m] * cos + waves[1, m] * sin
            g += wave
            slope += omega[m] * (waves[1, m] * cos - waves[0, m] * sin)
            curvature -= omega[m] ** 2 * wave
        if g <= 0.0 and slope < 0.0:
            return t, CONTACT
        step = safe_step(max(g, 0.0), slope, curvature, (second, third), least, limit)
        if slope < 0.0 and step <= EPS * (now + t):
            return t, CONTACT
        t += step
    return t, LOOK_AGAIN
