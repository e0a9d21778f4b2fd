"""A trajectory at other times, from the displacement and velocity of the four frames around each."""

from dataclasses import replace

import numpy as np

from analysis import hermite
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError

_NODES = (0, 1, 2, 3)

_SPARSER = 3
"""Frames from one to the next when the error is measured: halfway between two, that of velocities is at its least."""

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
    """Bound on the largest error of displacement and velocity from `at_times`; infinite with fewer than 12 frames.

    Every third frame gives those in between with an error that is larger by 3**3.5 and 3**2.5 where a contact opens or
    closes, and by 3**8 and 3**7 elsewhere. One power less is made use of, for safety.
    """
    if trajectory.frames < _SPARSER * len(_NODES):
        return float("inf"), float("inf")
    displacement = velocity = 0.0
    for first in range(_SPARSER):
        sparse = trajectory[first::_SPARSER]
        between = trajectory[first : first + _SPARSER * (sparse.frames - 1) + 1]
        found = at_times(sparse, between.time)
        displacement = max(displacement, float(np.max(np.abs(found.displacement - between.displacement))))
        velocity = max(velocity, float(np.max(np.abs(found.velocity - between.velocity))))
    return displacement / _SPARSER**2.5, velocity / _SPARSER**1.5
