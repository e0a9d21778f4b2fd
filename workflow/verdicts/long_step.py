"""Whether a trajectory differs from the reference by its time step: it is the emulated one of a longer step."""

from dataclasses import replace

import numpy as np

from analysis.trajectory import Floats, Trajectory
from workflow.engines.reference import engine
from workflow.prepare.pilot import TABLES

EXPLAINED = 0.1
"""Difference from the emulated run over that from the reference, largest of the velocities, at most."""

_MOSTLY = 0.5
"""Error of the reference over the difference from it, at most."""

_MOST_STEPS_PER_FRAME = 64

_MOST_BEAD_STEPS = 2e8
"""Length of all emulated runs together: some seconds."""


def long_step(trajectory: Trajectory, reference: Trajectory) -> list[str]:
    """Sentence on the time step with which LAMMPS's scheme leaves the difference; empty if none does.

    Args:
        trajectory: frames of all beads from the start on, evenly spaced.
        reference: the same frames as the scene has them.
    """
    problem, frames = trajectory.problem, trajectory.frames
    spacing = (trajectory.time[-1] - trajectory.time[0]) / max(1, frames - 1)
    even = np.allclose(np.diff(trajectory.time), spacing, rtol=1e-3, atol=0.0)
    even = even and trajectory.frames == reference.frames and np.allclose(trajectory.time, reference.time)
    if frames < 2 or not even or trajectory.time[0] != 0.0 or not problem.rows.complete or not trajectory.all_lines:
        return []
    at_spacing = replace(problem, timestep=spacing, steps_per_frame=1, frames=frames - 1)
    right = engine.run(at_spacing)
    apart = _apart(trajectory, right)
    if np.any(_apart(right, reference) > _MOSTLY * _apart(trajectory, reference)):  # the difference is not its own
        return []
    spent, best, steps = 0.0, np.full(2, np.inf), 1
    cycle = problem.cycle
    others = range(1, _MOST_STEPS_PER_FRAME + 1) if cycle == 1 else ()
    for count in dict.fromkeys([problem.steps_per_frame // cycle, *others]):
        spent += count * (frames - 1) * trajectory.velocity[0].size
        if spent > _MOST_BEAD_STEPS:
            break
        emulated = engine.run(
            replace(at_spacing, timestep=spacing / count / cycle, steps_per_frame=count * cycle),
            scheme=TABLES[problem.scheme],
            steps_per_frame=count,
        )
        difference = _apart(emulated, trajectory)
        best, steps = min((best, steps), (difference, count), key=lambda pair: float(np.max(pair[0] / apart)))
        if np.all(difference <= 0.1 * EXPLAINED * apart):
            break
    if not np.all(best <= EXPLAINED * apart):
        return []
    step = problem.scale.written(spacing / steps / cycle, "time", ".4g")
    return [
        f"the time step of {step} is too long: the scheme {problem.scheme} with it leaves {apart[0]:.2g} V, from which "
        f"the motion differs by {max(best[0], 1e-12):.1g} V; a shorter `timestep`, or `accuracy` instead"
    ]


def _apart(first: Trajectory, second: Trajectory) -> Floats:
    """Largest differences of velocities and of displacements of the beads."""
    pairs = ((first.velocity, second.velocity), (first.displacement, second.displacement))
    return np.array([np.max(np.abs(a - b)) for a, b in pairs]) + np.finfo(float).tiny
