"""How well a passage is found: bounds for the exact wave on a grid of times, and for noise on it, as measured."""

from dataclasses import dataclass
from typing import Any

from analysis.tracking.brackets import FAR_APART, on_a_grid
from analysis.tracking.noise import left_by_smoothing
from analysis.trajectory import Floats


@dataclass(frozen=True)
class PeakError:
    """Bounds on the error of passages: arrival in units of T, peak velocity in units of V; of the latter's shape."""

    arrival: Any
    peak_velocity: Any


def peak_error(
    every: float, peak_velocity: float | Floats, *, noise: float = 0.0, all_recorded: bool = True
) -> PeakError:
    """Error of an exact wave's passage found by `analysis.tracking.peaks`, four standard deviations where there is
    noise.

    Measured for peak velocities from 0.05 to 1 (with noise 0.2 to 1) and times between frames up to 1. Without noise it
    falls as ``every**5`` or faster: at 0.1, 4e-8 in arrival; at 1, 4e-3.

    Args:
        every: time between frames, in units of T.
        peak_velocity: of the wave, in units of V.
        noise: standard deviation of recorded displacements (L) and velocities (V).
        all_recorded: whether every bead is recorded.
    """
    if noise > 0.0:
        left = left_by_smoothing(noise, every)
        far = 2.0 if every >= FAR_APART else 1.0  # displacements are used there, and add their noise
        arrival = far * 4.0 * 7.0 * left / peak_velocity + 0.5 * every**3
        return PeakError(arrival, far * 4.0 * 2.5 * left + (2e-4 + 0.2 * every**3) * peak_velocity)
    return PeakError(*on_a_grid(every, peak_velocity, all_recorded=all_recorded))


def width_error(every: float) -> float:
    """Relative error of the full width at half maximum of an exact wave, from `analysis.shape.waveforms`, without
    noise.

    Largest measured over phases and peak velocities from 0.05 to 1: 5e-7 at 0.1, 2.4e-4 at 0.3, 3e-3 at 0.5, 1.6e-2 at
    0.7 and 9e-2 at 1, where two frames fall into the width; the bound is about twice that.

    Args:
        every: time between frames, in units of T.
    """
    return 4e-6 + 0.2 * every**5
