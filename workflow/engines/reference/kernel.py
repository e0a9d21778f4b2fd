"""The compiled loop of the reference integrator: kicks and drifts of the rows that can move.

| paper                       | here                  | shape                         |
|-----------------------------|-----------------------|-------------------------------|
| x_i^(j)                     | ``x[i, j - 1]``       | [bead + 2, chain]             |
| its first derivative        | ``v[i, j - 1]``       | [bead + 2, chain]             |
| (x_{i-1} - x_i - D)+^1.5    | ``push[i, j - 1]``    | [bead + 2, chain]             |
| everything else             | ``forces``            | see `forces`                  |

All dimensionless. Row i holds bead i of every chain; rows 0 and beads + 1 stay at zero. So any range of rows is one
piece of memory, and each loop runs over it without branches and becomes vector instructions.
"""

# ruff: noqa: ARG001, ARG005  numba wants the arguments of what is overloaded, used or not
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

from workflow.compiled import compiled, inner
from workflow.engines.reference.dashpots import Flow, Given, HalfStep, brake, flow, impulses, slide
from workflow.engines.reference.forces import (
    Forces,
    give_on,
    hold_on,
    kick_on,
    over_mass,
    pull,
    sum_of,
    travel_on,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@inner
def press(x: Floats, push: Floats, forces: Forces, chains: int, first: int, last: int) -> None:
    """Contact force on each bead of rows first + 1 to last from the bead behind it."""
    row, gap = np.uint64(chains), forces.gap
    for k in range(np.uint64((first + 1) * chains), np.uint64((last + 1) * chains)):
        push[k] = sum_of(forces.along, k, x[k - row] - x[k] - gap)


@inner
def kick(v: Floats, push: Floats, x: Floats, forces: Forces, factor: float, chains: int, first: int, last: int) -> None:
    """``v += factor * forces / masses`` in rows first to last, which nothing outside touches."""
    row = np.uint64(chains)
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        force = push[k] - push[k + row] - pull(forces.across, x, k) - sum_of(forces.ground, k, x[k])
        v[k] += factor * over_mass(force, forces.lightness, k)


@inner
def _drift(x: Floats, v: Floats, factor: float, chains: int, first: int, last: int) -> None:
    """``x += factor * v`` in rows first to last."""
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        x[k] += factor * v[k]


@inner
def _displaced(x: Floats, chains: int, row: int) -> bool:
    for k in range(row * chains, (row + 1) * chains):  # noqa: SIM110  numba compiles loops, not any()
        if x[k] != 0.0:
            return True
    return False


def keep_drag(dampers: Any, x: Any, v: Any, gap: Any, chains: Any, first: Any, last: Any) -> Any:
    """Note the forces of dashpots at these positions, where they are kept."""
    raise NotImplementedError


def kick_all(dampers: Any, v: Any, push: Any, x: Any, forces: Any, factor: Any, chains: Any, first: Any, last: Any
) -> Any:  # fmt: skip
    """A kick by all forces."""
    raise NotImplementedError


def drift_all(dampers: Any, x: Any, v: Any, forces: Any, time: Any, factor: Any, chains: Any, first: Any, last: Any
) -> Any:  # fmt: skip
    """A drift from a time on, under forces from outside, and with dashpots that are known by what they have given."""
    raise NotImplementedError


def velocities(dampers: Any, x: Any, v: Any, forces: Any, chains: Any, first: Any, last: Any) -> Any:
    """Velocities of a state; the array of the state where it holds them."""
    raise NotImplementedError


def _is(dampers: Any, kind: type) -> bool:
    return isinstance(dampers, types.NamedTuple) and dampers.instance_class is kind


@overload(keep_drag, strict=False)
def _keep_drag(dampers: Any, x: Any, v: Any, gap: Any, chains: Any, first: Any, last: Any) -> Any:
    if _is(dampers, HalfStep):
        return lambda dampers, x, v, gap, chains, first, last: brake(dampers, x, v, gap, chains, first, last)
    return lambda dampers, x, v, gap, chains, first, last: None


@overload(drift_all, strict=False)
def _drift_all(
    dampers: Any, x: Any, v: Any, forces: Any, time: Any, factor: Any, chains: Any, first: Any, last: Any
) -> Any:
    def plain(
        dampers: Any, x: Any, v: Any, forces: Any, time: Any, factor: Any, chains: Any, first: Any, last: Any
    ) -> None:
        _drift(x, v, factor, chains, first, last)
        low, high = first * chains, (last + 1) * chains
        travel_on(forces.drifted, forces.lightness, x, time, factor, low, high)
        travel_on(forces.moved, (), x, time, factor, low, high)
        give_on(forces.drifted, forces.lightness, forces.work, v, time, factor, low, high)
        give_on(forces.moved, (), (), v, time, factor, low, high)

    def sliding(
        dampers: Any, x: Any, v: Any, forces: Any, time: Any, factor: Any, chains: Any, first: Any, last: Any
    ) -> None:
        slide(dampers, x, v, forces, time, factor, chains, first, last)

    return sliding if _is(dampers, Given) else plain


@overload(velocities, strict=False)
def _velocities(dampers: Any, x: Any, v: Any, forces: Any, chains: Any, first: Any, last: Any) -> Any:
    if not _is(dampers, Given):
        return lambda dampers, x, v, forces, chains, first, last: v

    def with_impulses(dampers: Any, x: Any, v: Any, forces: Any, chains: Any, first: Any, last: Any) -> Any:
        impulses(dampers, x, forces.gap, chains, first, last)
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            dampers.actual[k] = v[k] + over_mass(dampers.drag[k], forces.lightness, k)
        return dampers.actual

    return with_impulses


@overload(kick_all, strict=False)
def _kick_all(
    dampers: Any, v: Any, push: Any, x: Any, forces: Any, factor: Any, chains: Any, first: Any, last: Any
) -> Any:
    def plain(
        dampers: Any, v: Any, push: Any, x: Any, forces: Any, factor: Any, chains: Any, first: Any, last: Any
    ) -> None:
        kick(v, push, x, forces, factor, chains, first, last)

    def half_step(
        dampers: Any, v: Any, push: Any, x: Any, forces: Any, factor: Any, chains: Any, first: Any, last: Any
    ) -> None:
        kick(v, push, x, forces, factor, chains, first, last)
        for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
            v[k] += factor * over_mass(dampers.drag[k], forces.lightness, k)

    def solved(
        dampers: Any, v: Any, push: Any, x: Any, forces: Any, factor: Any, chains: Any, first: Any, last: Any
    ) -> None:
        dampers.steady[first * chains : (last + 1) * chains] = 0.0
        kick(dampers.steady, push, x, forces, 1.0, chains, first, last)
        flow(dampers, v, x, forces.lightness, forces.gap, factor, chains, first, last)

    return half_step if _is(dampers, HalfStep) else solved if _is(dampers, Flow) else plain


def note(ledger: Any, frame: Any, dampers: Any, forces: Any) -> Any:
    """Write down what was counted until a frame."""
    raise NotImplementedError


def held_by(moved: Any, dampers: Any) -> Any:
    """What dashpots have taken from beads that are moved, and so from what moves them."""
    raise NotImplementedError


@overload(note, strict=False)
def _note(ledger: Any, frame: Any, dampers: Any, forces: Any) -> Any:
    if not isinstance(ledger, types.Array):
        return lambda ledger, frame, dampers, forces: None
    loses = _is(dampers, Given) or _is(dampers, Flow)
    works = isinstance(forces.types[Forces._fields.index("work")], types.Array)

    def lost(ledger: Any, frame: Any, dampers: Any, forces: Any) -> None:
        for kind in range(4):
            ledger[frame, kind] = np.sum(dampers.lost[kind])

    def put_in(ledger: Any, frame: Any, dampers: Any, forces: Any) -> None:
        ledger[frame, 4] = forces.work[0]

    def both(ledger: Any, frame: Any, dampers: Any, forces: Any) -> None:
        for kind in range(4):
            ledger[frame, kind] = np.sum(dampers.lost[kind])
        ledger[frame, 4] = forces.work[0] + held_by(forces.moved, dampers)

    return both if loses and works else lost if loses else put_in


@overload(held_by, strict=False)
def _held_by(moved: Any, dampers: Any) -> Any:
    if len(moved) == 0:
        return lambda moved, dampers: 0.0

    def held(moved: Any, dampers: Any) -> Any:
        k, (along, across, ground, walls) = moved[0][0], dampers.lost
        return along[k] + across[k] + ground[k] + walls[k] + held_by(moved[1:], dampers)

    return held


@inner
def step(
    x: Floats,
    v: Floats,
    push: Floats,
    stale: bool,
    span: Integers,
    window: int,
    kicks: Floats,
    drifts: Floats,
    time: float,
    h: float,
    forces: Forces,
    chains: int,
) -> bool:
    """One time step from a time on of the rows that can move; arguments as for `advance`.

    ``push`` holds the contact forces of the present positions unless ``stale``; returns whether they are so after it.
    """
    beads = x.shape[0] // chains - 2
    for stage in range(kicks.shape[0]):
        first, last = span[0], span[1]
        if kicks[stage] != 0.0:
            if stale:
                press(x, push, forces, chains, first, last)
                keep_drag(forces.dampers, x, v, forces.gap, chains, first, last)
                stale = False
            kick_all(forces.dampers, v, push, x, forces, kicks[stage] * h, chains, first, last)
            low, high = first * chains, (last + 1) * chains
            kick_on(forces.kicked, forces.lightness, v, time, h, kicks[stage] * h, low, high)
            hold_on(forces, forces.moved, push, x, v, kicks[stage] * h, chains)
        if stage < drifts.shape[0]:
            drift_all(forces.dampers, x, v, forces, time, drifts[stage] * h, chains, first, last)
            time += drifts[stage] * h
            stale = True
            if last < beads and _displaced(x, chains, last):
                last += 1
                if last - first >= window:
                    first = last - window + 1
                    push[first * chains : (first + 1) * chains] = 0.0
            if first > 1 and last - first + 1 < window and _displaced(x, chains, first):
                first -= 1
            span[0], span[1] = first, last
    return stale


@compiled
def advance(
    x: Floats,
    v: Floats,
    push: Floats,
    stale: bool,
    span: Integers,
    window: int,
    kicks: Floats,
    drifts: Floats,
    h: float,
    first_step: int,
    steps_per_frame: int,
    forces: Forces,
    recorded: Integers,
    frames_x: Floats,
    frames_v: Floats,
    ledger: Any,
) -> bool:
    """Advance a state by ``len(frames_x)`` frames and record the chosen beads at each.

    Only rows ``span[0]`` to ``span[1]`` are integrated. Beyond them nothing has moved: a row at rest feels no force
    until the row beside it is displaced, and the span always holds one such row at each end, so the result is bit for
    bit that of all rows. Rows more than ``window`` behind the last are let go and keep their last state.

    Args:
        x, v: state, flat; advanced in place.
        push, stale: as for `step`, which returns the latter.
        span: first and last row that may move; advanced in place.
        window: number of rows that are integrated at most.
        kicks, drifts, h: the scheme and its step.
        first_step: steps done before.
        steps_per_frame: steps between two frames.
        forces: of the problem.
        recorded: beads to record, counted from 1.
        frames_x, frames_v: filled, [frame, chain, bead].
        ledger: filled, [frame, entry] (`analysis.trajectory.Trajectory`), or an empty tuple.
    """
    chains = frames_x.shape[1]
    for frame in range(frames_x.shape[0]):
        for number in range(frame * steps_per_frame, (frame + 1) * steps_per_frame):
            time = (first_step + number) * h
            stale = step(x, v, push, stale, span, window, kicks, drifts, time, h, forces, chains)
        shown = velocities(forces.dampers, x, v, forces, chains, span[0], span[1])
        for j in range(chains):
            for k in range(recorded.shape[0]):
                frames_x[frame, j, k] = x[recorded[k] * chains + j]
                frames_v[frame, j, k] = shown[recorded[k] * chains + j]
        note(ledger, frame, forces.dampers, forces)
    return stale
