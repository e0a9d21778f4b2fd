"""What gave beads their momentum: its change from frame to frame, and the impulses of links and dampers on them.

Arrays are [interval, chain, bead], the intervals between two frames. Every bead must be recorded.
"""

from collections.abc import Iterable

import numpy as np

from analysis.trajectory import Floats, Trajectory
from lammps_inputs.links import Link


def integral(value: Floats, rate: Floats, spacing: Floats) -> Floats:
    """Integral between consecutive frames from values and rates there (corrected trapezoid, order 4)."""
    ends = 0.5 * spacing * (value[1:] + value[:-1])
    return np.asarray(ends + spacing**2 / 12.0 * (rate[:-1] - rate[1:]))


def spacing(trajectory: Trajectory) -> Floats:
    """Time between two frames, [interval, 1, 1]."""
    return np.diff(trajectory.time)[:, np.newaxis, np.newaxis]


def of_link(link: Link, trajectory: Trajectory) -> Floats:
    """Impulse of each of some links, by their forces and how these change at the frames."""
    x, v = trajectory.displacement, trajectory.velocity
    return integral(link.force(x), link.force_rate(x, v), spacing(trajectory))


def of_damper(damper: Link, trajectory: Trajectory) -> Floats:
    """Impulse of each of some dampers, which have given one for every strain."""
    return np.diff(damper.given(trajectory.displacement), axis=0)


def on_beads(link: Link, impulse: Floats, trajectory: Trajectory) -> Floats:
    """What impulses of links, or of dampers, give the beads."""
    column = np.zeros_like(trajectory.velocity[1:])
    link.drive(column, impulse)
    return column


def unexplained(
    trajectory: Trajectory, links: Iterable[Link] = (), dampers: Iterable[Link] = (), *, loads: bool = True
) -> Floats:
    """Change of momentum but for what these links and dampers and, if so, the forces from outside gave."""
    problem = trajectory.problem
    change: Floats = np.diff(trajectory.velocity, axis=0) * problem.system.mass
    for load in problem.system.loads if loads else ():
        change[:, load.chain - 1, load.bead - 1] -= np.diff(load.impulse(trajectory.time))
    for link in links:
        link.drive(change, -of_link(link, trajectory))
    for damper in dampers:
        damper.drive(change, -of_damper(damper, trajectory))
    return change
