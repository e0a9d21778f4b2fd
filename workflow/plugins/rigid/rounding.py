"""Collisions that follow rounding: how far a run of rigid beads is determined by its scene.

Rigid beads amplify small changes. At theta = n pi / 2 two beads touch without speed at the instant of a collision: a
change d of the gap moves that touch by a time of order d^(1/3), from row to row again, so that rounding, 1e-16, reaches
the first digit after four rows. Elsewhere changes grow by a factor at each collision. Runs whose gaps differ by
`CHANGE`, a little more than the rounding of an event, show from which collision on.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granchain.parts import Problem
from workflow.plugins.rigid.engine import CollisionRun, played_back, run

CHANGE = 2.0**-48
"""Relative change of the gap, 4e-15: 16 units in the last place."""

MOVED = 1e-3
"""Change of a displacement, over the least gap, or of an impulse, over m V, from which on a run follows rounding."""

SAMPLES = 4096
"""Collisions at most at which displacements are compared."""

BLOCK = 64
"""Collisions whose displacements are compared at a time."""


class ByRounding(NamedTuple):
    """Which collisions of a run follow rounding."""

    collisions: NDArray[np.bool_]
    """[collision]: `first` and those after it, and earlier ones that runs of other gaps do not have, whose impulse is
    at most `MOVED`"""
    first: int | None
    """place of the first from which on all do; None where there is none"""


def by_rounding(collisions: CollisionRun) -> ByRounding:
    """Find the collisions that follow rounding, from runs whose gap differs by `CHANGE` of it.

    The first is that at whose time a displacement differs by more than `MOVED` of the least gap, or an earlier one of
    an impulse above `MOVED` that another run does not have. Of runs of more than `SAMPLES` collisions it may be earlier
    by their number over `SAMPLES`.

    Args:
        collisions: a run.
    """
    problem, count = collisions.problem, len(collisions)
    gap = float(np.min(problem.system.along[0].gap))
    beside = [run(_with_other_gaps(problem, 1.0 + change)) for change in (-CHANGE, CHANGE)]
    first = _first_apart(collisions, beside, gap)
    end = count if first is None else first
    follow = np.arange(count) >= end
    for other in beside:
        follow[:end] |= ~_among(collisions, end, other, gap)
    large = np.flatnonzero(follow & (collisions.impulse > MOVED))
    if large.size:
        first = int(large[0]) if first is None else min(first, int(large[0]))
        follow[first:] = True
    return ByRounding(follow, first)


def _first_apart(collisions: CollisionRun, beside: list[CollisionRun], gap: float) -> int | None:
    """Place of the first collision at whose time displacements differ by more than `MOVED` of the gap."""
    stride = max(1, -(-len(collisions) // SAMPLES))
    times = collisions.time[::stride]
    blocks = zip(*(played_back(each, times, BLOCK) for each in (collisions, *beside)), strict=True)
    for number, (middle, *others) in enumerate(blocks):
        moved = np.max([np.abs(other.displacement - middle.displacement) for other in others], axis=(0, 2, 3))
        if (far := np.flatnonzero(moved > MOVED * gap)).size:
            sampled = number * BLOCK + int(far[0])
            return 0 if sampled == 0 else (sampled - 1) * stride + 1
    return None


def _among(collisions: CollisionRun, end: int, other: CollisionRun, gap: float) -> NDArray[np.bool_]:
    """Whether another run has a collision of the same beads, time and impulse, to within `MOVED`, [collision < end]."""
    if not len(other):
        return np.zeros(end, dtype=bool)
    pairs, other_pairs = (run.chain * run.problem.beads + run.row for run in (collisions, other))
    apart = 2.0 * max(collisions.until, other.until)  # of pairs on one axis
    axis = other_pairs * apart + other.time
    order = np.argsort(axis, kind="stable")
    after = np.searchsorted(axis[order], (pairs * apart + collisions.time)[:end])
    same = np.zeros(end, dtype=bool)
    for place in (after - 1, after):
        nearest = order[np.clip(place, 0, len(order) - 1)]
        moved = np.abs(other.time[nearest] - collisions.time[:end]) * collisions.impulse[:end]
        changed = np.abs(other.impulse[nearest] - collisions.impulse[:end])
        same |= (other_pairs[nearest] == pairs[:end]) & (moved <= MOVED * gap) & (changed <= MOVED)
    return same


def _with_other_gaps(problem: Problem, factor: float) -> Problem:
    """A problem of rigid beads with a factor on its gaps."""
    along, links = problem.system.along, problem.system.links
    links = (*(replace(link, gap=link.gap * factor) for link in along), *links[len(along) :])  # contacts are the first
    return replace(problem, system=replace(problem.system, links=links))
