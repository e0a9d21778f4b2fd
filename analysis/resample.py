"""A trajectory at other times, from the displacement and velocity of the four frames around each."""

from dataclasses import replace

import numpy as np

from analysis import hermite
from analysis.trajectory import Floats, Trajectory

_NODES = (0, 1, 2, 3)


def at_times(trajectory: Trajectory, times: Floats) -> Trajectory:
    """The states at given times within the trajectory's own, by polynomials of degree seven.

    Raises:
        ValueError: a time lies outside, or there are fewer than four frames.
    """
    own = trajectory.time
    if trajectory.frames < len(_NODES):
        raise ValueError(f"{trajectory.frames} frames are too few to interpolate between")
    margin = 1e-9 * (own[-1] - own[0])
    if len(times) and (times[0] < own[0] - margin or times[-1] > own[-1] + margin):
        raise ValueError(
            f"times {times[0]:.6g} to {times[-1]:.6g} reach beyond the trajectory's {own[0]:.6g} to {own[-1]:.6g}"
        )
    spacing = (own[-1] - own[0]) / (trajectory.frames - 1)
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
    """Estimated largest error of displacement and velocity from `at_times`.

    Frames left out and interpolated from every second one are off by an error that falls as spacing**8 and spacing**7.
    """
    if trajectory.frames < 2 * len(_NODES) + 1:
        return float("inf"), float("inf")
    coarse, between = trajectory[::2], trajectory[1 : trajectory.frames - 1 : 2]
    found = at_times(coarse, between.time[between.time <= coarse.time[-1]])
    known = between[: found.frames]
    displacement = float(np.max(np.abs(found.displacement - known.displacement)))
    velocity = float(np.max(np.abs(found.velocity - known.velocity)))
    return displacement / 2.0**8, velocity / 2.0**7
