"""The leading pulse at every bead without keeping a frame: for chains too long to record.

Integrates like `engine.blocks`, in a window of rows behind the front if asked, and notes for each bead the first
maximum of its velocity, from the cubic polynomial through velocity and acceleration at the two steps around it (error
below 1e-5 of V at the default step).
"""

import math
from dataclasses import dataclass

import numpy as np

from analysis.tracking.leading_waves import Waves, with_speeds
from analysis.tracking.peaks import THRESHOLD
from lammps_inputs import Problem, physics
from lammps_inputs.limits import rates
from lammps_inputs.limits.rates import stability_bound
from workflow.engines.reference import engine
from workflow.engines.reference.kernel import Passing
from workflow.engines.reference.schemes import BLANES_MOAN


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
    system = problem.system
    step = 0.1 / math.sqrt(max(1.0, rates.modal_frequency(system) ** 2 / 2.0))
    return step if physics.alike(system) and not physics.loaded(system) else min(step, stability_bound(system) / 8.0)


def passages(
    problem: Problem,
    *,
    window: int | None = None,
    timestep: float | None = None,
    until_bead: int | None = None,
    threshold: float = THRESHOLD,
) -> Passages:
    """Integrate until a bead is passed in every chain, or to the problem's end, noting the leading pulse at each bead.

    Args:
        problem: what to integrate; its own time step and frames are not used, only its duration.
        window: rows that are integrated at most, those behind are let go; None for all.
        timestep: of the scheme, in units of T; by default `usual_timestep`.
        until_bead: stop when every chain's pulse has passed it.
        threshold: smallest peak that counts, in units of V.

    Raises:
        ValueError: a window that is too narrow.
    """
    timestep = usual_timestep(problem) if timestep is None else timestep
    state = engine.make_state(problem, window)
    arrival, peak = np.full((2, *state.x.shape), np.nan)
    starting = state.v > threshold
    arrival[starting], peak[starting] = 0.0, state.v[starting]
    passing = Passing(arrival.reshape(-1), peak.reshape(-1), *np.zeros((3, state.x.size)))
    steps = engine.make_steps(BLANES_MOAN, timestep)
    last = problem.beads if until_bead is None else until_bead
    total, chunk, done, let_go = int(np.ceil(problem.duration / timestep)), 1000, 0, 0.0
    while done < total and np.any(np.isnan(arrival[last, : problem.chains])):
        count = min(chunk, total - done)
        fastest = state.program.follow(state.compiled, state.parameters, steps, done, count, threshold, passing)
        let_go = max(let_go, fastest)
        done += count
    arrival, peak = (values[1:-1, : problem.chains].T for values in (arrival, peak))
    chain, row = np.nonzero(~np.isnan(arrival))
    waves = with_speeds(chain + 1, row + 1, arrival[chain, row], peak[chain, row])
    return Passages(waves, let_go, done * timestep)
