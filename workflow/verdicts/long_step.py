"""Whether a trajectory differs from the reference by its time step: it is the emulated one of a longer step."""

from dataclasses import replace

import numpy as np

from analysis.trajectory import Trajectory
from lammps_inputs import scheme
from workflow.engines.reference import engine
from workflow.prepare.pilot import TABLES

EXPLAINED = 0.1
"""Difference from the emulated run over that from the reference, largest of the velocities, at most."""

_MOST_STEPS_PER_FRAME = 64

_MOST_BEAD_STEPS = 2e8
"""Length of all emulated runs together: some seconds."""


def long_step(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """Sentence on the time step with which LAMMPS's scheme leaves the difference from the reference; empty if none does.

    Args:
        trajectory: frames of all beads from the start on, evenly spaced.
        reference: the same frames as the scene has them.
    """
    problem, frames = trajectory.problem, trajectory.frames
    spacing = (trajectory.time[-1] - trajectory.time[0]) / max(1, frames - 1)
    even = np.allclose(np.diff(trajectory.time), spacing, rtol=1e-3, atol=0.0)
    even = even and trajectory.frames == reference.frames and np.allclose(trajectory.time, reference.time)
    if frames < 2 or not even or trajectory.time[0] != 0.0 or not problem.whole or not trajectory.complete:
        return []
    apart = float(np.max(np.abs(trajectory.velocity - reference.velocity)))
    spent, best = 0.0, (np.inf, 0)
    cycle = scheme.cycle(problem.scheme)
    others = range(1, _MOST_STEPS_PER_FRAME + 1) if cycle == 1 else ()
    for steps in dict.fromkeys([problem.steps_per_frame // cycle, *others]):
        spent += steps * (frames - 1) * trajectory.velocity[0].size
        if spent > _MOST_BEAD_STEPS:
            break
        emulated = engine.run(
            replace(
                problem,
                timestep=spacing / steps / cycle,
                steps_per_frame=steps * cycle,
                frames=frames - 1,
                recorded=None,
            ),
            scheme=TABLES[problem.scheme],
            steps_per_frame=steps,
        )
        difference = float(np.max(np.abs(emulated.velocity - trajectory.velocity)))
        best = min(best, (difference, steps))
        if difference <= 0.1 * EXPLAINED * apart:
            break
    difference, steps = best
    if not difference <= EXPLAINED * apart:
        return []
    step = problem.scale.written(spacing / steps / cycle, "time", ".4g")
    return [
        f"the time step of {step} is too long: the scheme {problem.scheme} with it leaves {apart:.2g} V, from which the "
        f"motion differs by {difference:.1g} V; a shorter `timestep`, or `accuracy` instead"
    ]
