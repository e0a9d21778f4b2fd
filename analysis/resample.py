"""A trajectory at other times, from the displacement and velocity of the four frames around each."""

from dataclasses import replace

import numpy as np

from analysis import hermite
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError

_NODES = (0, 1, 2, 3)

MARGIN = 0.01
"""How far beyond its ends a trajectory is continued, in frames: for times that were rounded to six digits."""


def at_times(trajectory: Trajectory, times: Floats) -> Trajectory:
    """The states at given times within the trajectory's own, by polynomials of degree seven.

    Raises:
        InputError: a time lies outside by more than a hundredth of a frame, or there are fewer than four frames, or
            they are not evenly spaced.
    """
    own = trajectory.time
    if trajectory.frames < len(_NODES):
        raise InputError(f"{trajectory.frames} frames are too few to interpolate between; at least {len(_NODES)}")
    spacing = (own[-1] - own[0]) / (trajectory.frames - 1)
    if not np.allclose(np.diff(own), spacing, rtol=1e-6, atol=0.0):
        raise InputError("frames are not evenly spaced in time, so there is no interpolating between them")
    if len(times) and (times[0] < own[0] - MARGIN * spacing or times[-1] > own[-1] + MARGIN * spacing):
        raise InputError(
            f"times {times[0]:.6g} to {times[-1]:.6g} reach beyond the run's {own[0]:.6g} to {own[-1]:.6g} "
            "(dimensionless)"
        )
    start = np.clip(np.searchsorted(own, times, side="right") - 2, 0, trajectory.frames - len(_NODES))
    data = np.array([(trajectory.displacement[start + node], trajectory.velocity[start + node]) for node in _NODES])
    polynomials = hermite.coefficients(_NODES, data, float(spacing))
    s = ((times - own[start]) / spacing)[:, np.newaxis, np.newaxis] * np.ones(trajectory.displacement.shape[1:])
    return replace(
        trajectory,
        time=times,
        displacement=hermite.value(polynomials, s),
        velocity=hermite.value(hermite.derivative(polynomials), s) / spacing,
    )


def interpolation_error(trajectory: Trajectory) -> tuple[float, float]:
    """Bound on the largest error of displacement and velocity from `at_times`; infinite with fewer than nine frames.

    It is the error with which every second frame gives those in between. Where contacts open and close that error falls
    as spacing**3.5 and spacing**2.5 only (elsewhere as spacing**8 and spacing**7), and that of velocities is not at its
    largest in the middle, so it is taken as it is: some 6 to 100 and 1.3 to 20 times the error.
    """
    if trajectory.frames < 2 * len(_NODES) + 1:
        return float("inf"), float("inf")
    coarse, between = trajectory[::2], trajectory[1 : trajectory.frames - 1 : 2]
    found = at_times(coarse, between.time[between.time <= coarse.time[-1]])
    known = between[: found.frames]
    displacement = float(np.max(np.abs(found.displacement - known.displacement)))
    velocity = float(np.max(np.abs(found.velocity - known.velocity)))
    return displacement, velocity
