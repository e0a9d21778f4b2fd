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

import numpy as np
from numpy.typing import NDArray

from workflow.compiled import compiled
from workflow.engines.reference.forces import Forces, drift_on, kick_on, over_mass, pull, sum_of

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@compiled
def press(x: Floats, push: Floats, forces: Forces, chains: int, first: int, last: int) -> None:
    """Contact force on each bead of rows first + 1 to last from the bead behind it."""
    row, gap = np.uint64(chains), forces.gap
    for k in range(np.uint64((first + 1) * chains), np.uint64((last + 1) * chains)):
        push[k] = sum_of(forces.along, k, x[k - row] - x[k] - gap)


@compiled
def kick(v: Floats, push: Floats, x: Floats, forces: Forces, factor: float, chains: int, first: int, last: int) -> None:
    """``v += factor * forces / masses`` in rows first to last, which nothing outside touches."""
    row = np.uint64(chains)
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        force = push[k] - push[k + row] - pull(forces.across, x, k) - sum_of(forces.ground, k, x[k])
        v[k] += factor * over_mass(force, forces.lightness, k)


@compiled
def _drift(x: Floats, v: Floats, factor: float, chains: int, first: int, last: int) -> None:
    """``x += factor * v`` in rows first to last."""
    for k in range(np.uint64(first * chains), np.uint64((last + 1) * chains)):
        x[k] += factor * v[k]


@compiled
def _displaced(x: Floats, chains: int, row: int) -> bool:
    for k in range(row * chains, (row + 1) * chains):  # noqa: SIM110  numba compiles loops, not any()
        if x[k] != 0.0:
            return True
    return False


@compiled
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
                stale = False
            kick(v, push, x, forces, kicks[stage] * h, chains, first, last)
            low, high = first * chains, (last + 1) * chains
            kick_on(forces.kicked, forces.lightness, v, time, h, kicks[stage] * h, low, high)
        if stage < drifts.shape[0]:
            _drift(x, v, drifts[stage] * h, chains, first, last)
            low, high = first * chains, (last + 1) * chains
            drift_on(forces.drifted, forces.lightness, x, v, time, drifts[stage] * h, low, high)
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
    """
    chains = frames_x.shape[1]
    for frame in range(frames_x.shape[0]):
        for number in range(frame * steps_per_frame, (frame + 1) * steps_per_frame):
            time = (first_step + number) * h
            stale = step(x, v, push, stale, span, window, kicks, drifts, time, h, forces, chains)
        for j in range(chains):
            for k in range(recorded.shape[0]):
                frames_x[frame, j, k] = x[recorded[k] * chains + j]
                frames_v[frame, j, k] = v[recorded[k] * chains + j]
    return stale
