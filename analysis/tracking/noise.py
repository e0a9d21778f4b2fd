"""Records with noise on them: how much it is, and frames smoothed in time so that pulses can be found in them.

What a simulation writes has none; a measured or a truncated record has. At the start every state is known exactly, so
the first frame shows the noise. `peak_error` says how well a passage is found, as measured.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from analysis.shape.exact_wave import SolitaryWave
from analysis.tracking.brackets import FAR_APART
from analysis.tracking.peaks import Peaks
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import physics

NEGLIGIBLE = 1e-6
"""Standard deviation, in units of V, below which a record counts as free of noise."""

APART = 1.5
"""Least distance of two maxima of a noisy record, in passages of the higher wave: its foot ends there."""

WINDOW = 1.2
"""Length in time of the smoothing window, in units of T: two thirds of the time that a wave of amplitude 1 takes to
pass at half its height (1.74), so that a polynomial of degree 4 follows it to within 2e-4 of its height.
"""

DEGREE = 4


def noise_at_start(first: Trajectory) -> float:
    """Standard deviation of the recorded velocities at time 0 from those of the scene, in units of V.

    0 if the frames do not begin at the start.
    """
    if first.time[0] != 0.0:
        return 0.0
    exact = physics.initial_velocity(first.problem.system)[:, first.beads - 1]
    found = float(np.sqrt(np.mean((first.velocity[0] - exact) ** 2)))
    return found if found > NEGLIGIBLE else 0.0


def window_frames(every: float) -> int:
    """Frames in the smoothing window: an odd number; 1, which smooths nothing, where frames are too far apart."""
    half = int(0.5 * WINDOW / every)
    return 2 * half + 1 if 2 * half + 1 > DEGREE + 1 else 1


def left_by_smoothing(noise: float, every: float) -> float:
    """Standard deviation of the noise that smoothing leaves, in units of V."""
    frames = window_frames(every)
    if noise == 0.0 or frames == 1:
        return noise
    from scipy.signal import savgol_coeffs  # a second to load, and few records have noise

    return noise * float(np.sqrt(savgol_coeffs(frames, DEGREE)[frames // 2]))


def smoothed(blocks: Iterable[Trajectory], every: float) -> Iterator[Trajectory]:
    """Blocks of the same frames, each replaced by a polynomial fitted in time to those around it.

    Savitzky & Golay, Anal. Chem. 36, 1627 (1964). Holds one window of frames beside the block.
    """
    window = window_frames(every)
    if window == 1:
        yield from blocks
        return
    half, pending, begun = window // 2, None, False
    for block in blocks:
        pending = block if pending is None else joined([pending, block])
        if pending.frames <= 2 * window:
            continue
        end = pending.frames - half - 1  # a whole window stays for the frames that follow, or for the end
        yield _filtered(pending, window)[half if begun else 0 : end]
        pending, begun = pending[end - half :], True
    if pending is not None:
        yield (_filtered(pending, window) if pending.frames >= window else pending)[half if begun else 0 :]


def _filtered(frames: Trajectory, window: int) -> Trajectory:
    return replace(
        frames,
        displacement=_smooth(frames.displacement, window),
        velocity=_smooth(frames.velocity, window),
    )


def _smooth(values: Floats, window: int) -> Floats:
    """Fitted values [frame, ...]; half a window at either end from a straight line, the least noisy there."""
    from scipy.signal import savgol_filter

    half = window // 2
    result: Floats = savgol_filter(values, window, DEGREE, axis=0)
    base = np.stack([np.ones(window), np.arange(window) - half], axis=1)
    line = base @ np.linalg.pinv(base)
    result[:half] = np.tensordot(line[:half], values[:window], axes=1)
    result[-half:] = np.tensordot(line[-half:], values[-window:], axes=1)
    return result


def distinct(peaks: Peaks, exact: SolitaryWave) -> Peaks:
    """The maxima of a noisy record without those that belong to one passage.

    Left out is whatever is nearer to a higher maximum of its bead than `APART` times the time in which the exact wave
    of that height passes at half its height.
    """
    while len(peaks) > 1:
        near = APART * exact.width / exact.speed_at(peaks.velocity)
        same = (np.diff(peaks.chain) == 0) & (np.diff(peaks.bead) == 0)
        first_higher = peaks.velocity[:-1] >= peaks.velocity[1:]
        merged = same & (np.diff(peaks.time) < np.where(first_higher, near[:-1], near[1:]))
        if not np.any(merged):
            break
        lower = np.zeros(len(peaks), dtype=bool)
        lower[1:] |= merged & first_higher
        lower[:-1] |= merged & ~first_higher
        peaks = peaks.where(~lower)
    return peaks


def peak_error(every: float, peak_velocity: Floats, noise: float) -> tuple[Floats, Floats]:
    """Error of arrival (T) and peak velocity (V) of an exact wave in a noisy record: four standard deviations.

    Measured for peak velocities from 0.2 to 1 and times between frames up to 1. Without noise it is
    `analysis.tracking.brackets.on_a_grid`.

    Args:
        every: time between frames, in units of T.
        peak_velocity: of the wave, in units of V.
        noise: standard deviation of recorded displacements (L) and velocities (V).
    """
    left = left_by_smoothing(noise, every)
    far = 2.0 if every >= FAR_APART else 1.0  # displacements are used there, and add their noise
    arrival = far * 4.0 * 7.0 * left / peak_velocity + 0.5 * every**3
    return arrival, far * 4.0 * 2.5 * left + (2e-4 + 0.2 * every**3) * peak_velocity


def width_error(every: float) -> float:
    """Relative error of the full width at half maximum of an exact wave, from `analysis.shape.waveforms`, without
    noise.

    Largest measured over phases and peak velocities from 0.05 to 1: 5e-7 at 0.1, 2.4e-4 at 0.3, 3e-3 at 0.5, 1.6e-2 at
    0.7 and 9e-2 at 1, where two frames fall into the width; the bound is about twice that.

    Args:
        every: time between frames, in units of T.
    """
    return 4e-6 + 0.2 * every**5
