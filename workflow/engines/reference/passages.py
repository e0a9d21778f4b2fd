"""The leading pulse at every bead without keeping a frame: for chains too long to record.

Integrates like `kernel.advance`, in a window of rows behind the front if asked, and notes for each bead the first
maximum of its velocity, from the cubic polynomial through velocity and acceleration at the two steps around it (error
below 1e-5 of V at the default step).
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.tracking.leading_waves import Waves, with_speeds
from analysis.tracking.peaks import THRESHOLD
from lammps_inputs import Problem
from lammps_inputs.limits import rates
from lammps_inputs.limits.timestep import stability_bound
from workflow.compiled import compiled, inner
from workflow.engines.reference import engine
from workflow.engines.reference.blanes_moan import BLANES_MOAN
from workflow.engines.reference.dashpots import slow
from workflow.engines.reference.forces import Forces, force_on
from workflow.engines.reference.kernel import Floats, Integers, kick, press, step, velocities
from workflow.engines.reference.scheme import Scheme


@inner
def _accelerate(x: Floats, v: Floats, a: Floats, push: Floats, forces: Forces, span: Integers, time: float) -> None:
    """Accelerations [row, chain] in the rows of a span, everything flat but ``a``."""
    chains = a.shape[1]
    press(x, push, forces, chains, span[0], span[1])
    a[span[0] : span[1] + 1] = 0.0
    kick(a.reshape(-1), push, x, forces, 1.0, chains, span[0], span[1])
    slow(forces.dampers, x, v, a.reshape(-1), forces, chains, span[0], span[1])
    force_on(forces.drifted, forces.lightness, a.reshape(-1), time, span[0] * chains, (span[1] + 1) * chains)
    force_on(forces.moved, (), a.reshape(-1), time, span[0] * chains, (span[1] + 1) * chains)


@inner
def _note(
    v: Floats, a: Floats, v_before: Floats, a_before: Floats, span: Integers, time: float, h: float,
    threshold: float, arrival: Floats, peak: Floats,
) -> int:  # fmt: skip
    """Note beads whose acceleration fell through zero during the step that ended at ``time``; how many."""
    noted = 0
    for row in range(span[0], span[1] + 1):
        for j in range(v.shape[1]):
            if not np.isnan(arrival[row, j]) or not (a_before[row, j] > 0.0 and a[row, j] <= 0.0):
                continue
            # v(s) = v0 + s (a0 h) + s**2 q + s**3 r on the step, 0 <= s <= 1; its slope falls through zero once
            v0, v1, a0, a1 = v_before[row, j], v[row, j], a_before[row, j] * h, a[row, j] * h
            q, r = 3.0 * (v1 - v0) - 2.0 * a0 - a1, 2.0 * (v0 - v1) + a0 + a1
            low, high = 0.0, 1.0
            for _ in range(50):
                s = 0.5 * (low + high)
                if a0 + s * (2.0 * q + s * 3.0 * r) > 0.0:
                    low = s
                else:
                    high = s
            top = v0 + s * (a0 + s * (q + s * r))
            if top > threshold:
                arrival[row, j] = time - h + s * h
                peak[row, j] = top
                noted += 1
    return noted


@compiled
def _pass(
    x: Floats, v: Floats, push: Floats, span: Integers, window: int, kicks: Floats, drifts: Floats, h: float,
    first_step: int, steps: int, forces: Forces, threshold: float, arrival: Floats,
    peak: Floats, a: Floats, a_before: Floats, v_before: Floats,
) -> float:  # fmt: skip
    """Some steps; returns the largest |velocity| that a row had when it was let go."""
    chains = a.shape[1]
    v_rows = velocities(forces.dampers, x, v, forces, chains, span[0], span[1]).reshape((-1, chains))
    let_go = 0.0
    stale: Any = np.bool_(True)  # a literal would compile `step` once more
    for number in range(first_step, first_step + steps):
        before = span[0]
        for row in range(span[0], span[1] + 1):
            for j in range(chains):
                v_before[row, j] = v_rows[row, j]
                a_before[row, j] = a[row, j]
        step(x, v, push, stale, span, window, kicks, drifts, number * h, h, forces, chains)
        velocities(forces.dampers, x, v, forces, chains, span[0], span[1])
        for row in range(before, span[0]):
            for j in range(chains):
                let_go = max(let_go, abs(v_rows[row, j]))
        _accelerate(x, v_rows.reshape(-1), a, push, forces, span, (number + 1) * h)
        _note(v_rows, a, v_before, a_before, span, (number + 1) * h, h, threshold, arrival, peak)
    return let_go


@dataclass(frozen=True)
class Passages:
    """What `passages` found.

    Attributes:
        waves: the leading pulse at every bead that it reached.
        let_go: largest |velocity| of a row when it left the window, in units of V; 0 without a window.
        time: at which the integration ended.
    """

    waves: Waves
    let_go: float
    time: float


def usual_timestep(problem: Problem) -> float:
    """0.1, or less where the springs are stiff, in units of T: peaks are then right to below 1e-5 of V."""
    step = 0.1 / math.sqrt(max(1.0, rates.swing(problem) ** 2 / 2.0))
    return step if problem.alike and not problem.loaded else min(step, stability_bound(problem) / 8.0)


def passages(
    problem: Problem,
    *,
    window: int | None = None,
    timestep: float | None = None,
    until_bead: int | None = None,
    scheme: Scheme = BLANES_MOAN,
    threshold: float = THRESHOLD,
) -> Passages:
    """Integrate until a bead is passed in every chain, or to the problem's end, noting the leading pulse at each bead.

    Args:
        problem: what to integrate; its own time step and frames are not used, only its duration.
        window: rows that are integrated at most, those behind are let go; None for all.
        timestep: of the scheme, in units of T; by default `usual_timestep`.
        until_bead: stop when every chain's pulse has passed it.
        scheme: how to integrate.
        threshold: smallest peak that counts, in units of V.

    Raises:
        ValueError: a window that is too narrow.
    """
    timestep = usual_timestep(problem) if timestep is None else timestep
    state = engine.make_state(problem, window)
    shape = state.x.shape
    arrival, peak = np.full(shape, np.nan), np.full(shape, np.nan)
    work = [np.zeros(shape) for _ in range(3)]
    push = np.zeros(state.x.size)
    starting = state.v > threshold
    arrival[starting], peak[starting] = 0.0, state.v[starting]
    last = problem.beads if until_bead is None else until_bead
    total, chunk, done, let_go = int(np.ceil(problem.duration / timestep)), 1000, 0, 0.0
    while done < total and np.any(np.isnan(arrival[last])):
        count = min(chunk, total - done)
        let_go = max(
            let_go,
            _pass(
                state.x.reshape(-1), state.v.reshape(-1), push, state.span, state.window, np.array(scheme.kicks),
                np.array(scheme.drifts), timestep, done, count, state.forces, threshold, arrival, peak, *work,
            ),
        )  # fmt: skip
        done += count
    found = ~np.isnan(arrival[1:-1].T)
    chain, row = np.nonzero(found)
    waves = with_speeds(chain + 1, row + 1, arrival[1:-1].T[found], peak[1:-1].T[found])
    return Passages(waves, let_go, done * timestep)
