"""What is wrong with a trajectory, as far as it can be told from the numbers alone.

Three things are measured: to how many digits the numbers were rounded (`precision`), by how much a quantity is shifted
in time (`time_shift`; displacement and velocity may be so by different amounts), and which springs the beads felt
(`identify_springs`, from the change of momentum between frames, once contacts are taken away). What follows from the
measurements is for others to say.
"""

from dataclasses import dataclass

import numpy as np

from analysis.trajectory import Floats, Trajectory
from lammps_inputs import contact

SINGLE = "single precision"

MOST_DIGITS = 12
"""Numbers with more digits than that pass for whole ones; float64 has 16."""

_ROUNDING = 8.0 * np.finfo(float).eps
"""What a number may have lost, of its size, by taking its rest position off and on."""


def precision(values: Floats) -> str | None:
    """What all of many numbers were rounded to: such as "6 digits" (``%g``), "8 decimals", or `SINGLE`; else None.

    Whole numbers tell nothing; None where fewer than 20 different others are found.
    """
    telling = values[np.isfinite(values) & (values != np.round(values))].ravel()
    sample = np.unique(telling[:: max(1, len(telling) // 2000)])
    if len(sample) < 20:
        return None
    size = np.abs(sample)
    found = []
    for word in ("digits", "decimals"):
        for count in range(MOST_DIGITS, 0, -1):
            step = 10.0 ** -count * (10.0 * 10.0 ** np.floor(np.log10(size)) if word == "digits" else np.ones(len(size)))
            if not np.all(_ROUNDING * size <= 0.01 * step):  # float64 itself is no finer
                continue
            form = f".{count - 1}e" if word == "digits" else f".{count}f"
            if not _all_are(sample, np.array([float(format(value, form)) for value in sample.tolist()])):
                break
            found.append((count, word))
    if found:
        count, word = min(found)
        return f"{count} {word}"
    with np.errstate(over="ignore", under="ignore"):
        if _all_are(sample, sample.astype(np.float32).astype(np.float64)):
            return SINGLE
    return None


def _all_are(sample: Floats, rounded: Floats) -> bool:
    """Whether as good as all numbers are the rounded ones."""
    return float(np.mean(np.abs(rounded - sample) <= _ROUNDING * np.abs(sample))) > 0.99


@dataclass(frozen=True)
class Shift:
    """Best shift in time of one quantity against a reference.

    Attributes:
        time: how far it is ahead: at t it has the value that the reference has at t + time; in units of T.
        explained: share of the squared difference that the shift explains, 0 to 1.
    """

    time: float
    explained: float


def time_shift(difference: Floats, rate: Floats) -> Shift:
    """Fit ``difference = shift * rate`` by least squares; ``rate`` is the reference's time derivative."""
    power = float(np.sum(rate * rate))
    total = float(np.sum(difference * difference))
    if power == 0.0 or total == 0.0:
        return Shift(0.0, 0.0)
    shift = float(np.sum(difference * rate)) / power
    return Shift(shift, shift * shift * power / total)


@dataclass(frozen=True)
class Springs:
    """Springs that the beads of a trajectory felt.

    Attributes:
        linear: stiffness of each spring between chains j and j + 1 in row i, [spring, row]; NaN where it hardly moved.
        cubic: coefficient of the cube of the relative displacement that fits better than any linear spring; else 0.
        residual: share of the springs' impulses that linear springs leave unexplained, 0 to 1.
    """

    linear: Floats
    cubic: float
    residual: float


_APART = 1e-6
"""Least relative displacement that is more than rounding, in units of L."""


def identify_springs(trajectory: Trajectory) -> Springs | None:
    """Fit the springs between the chains to a trajectory of all beads.

    None for one chain, for fewer than ten frames, or where the chains never move apart.

    Between two frames, the change of a bead's velocity minus the impulse of its contacts is the impulse of its springs.
    Summed over the chains from the first to j, all that is left is the spring between j and j + 1. Impulses are
    integrals from the forces and their rates at the two frames (corrected trapezoid, order 4).
    """
    problem = trajectory.problem
    if problem.chains < 2 or problem.recorded is not None or trajectory.frames < 10:
        return None
    x, v = trajectory.displacement, trajectory.velocity
    spacing = np.diff(trajectory.time)[:, np.newaxis, np.newaxis]
    push = contact.force(x[..., :-1] - x[..., 1:] - problem.gap)
    rate = contact.stiffness(x[..., :-1] - x[..., 1:] - problem.gap) * (v[..., :-1] - v[..., 1:])
    impulse = _integral(push, rate, spacing)
    change = np.diff(v, axis=0)
    change[..., 1:] -= impulse
    change[..., :-1] += impulse
    felt = np.cumsum(change, axis=1)[:, :-1]
    relative, relative_rate = x[:, 1:] - x[:, :-1], v[:, 1:] - v[:, :-1]
    if np.max(np.abs(relative)) < _APART:
        return None
    stretch = _integral(relative, relative_rate, spacing)
    cube = _integral(relative**3, 3.0 * relative**2 * relative_rate, spacing)
    power = np.sum(stretch * stretch, axis=0)
    moved = power > 1e-4 * power.max()
    with np.errstate(divide="ignore", invalid="ignore"):  # rows that never moved
        linear = np.where(moved, np.sum(felt * stretch, axis=0) / power, np.nan)
    total = float(np.sum(felt * felt))
    if total == 0.0:
        return Springs(np.zeros_like(linear), 0.0, 0.0)
    common = float(np.sum(felt * stretch) / np.sum(stretch * stretch))
    left = float(np.sum((felt - common * stretch) ** 2)) / total
    cubic = float(np.sum(felt * cube) / np.sum(cube * cube))
    left_by_cubic = float(np.sum((felt - cubic * cube) ** 2)) / total
    return Springs(linear, cubic if left_by_cubic < 0.1 * left else 0.0, left)


def _integral(value: Floats, rate: Floats, spacing: Floats) -> Floats:
    """Integral between consecutive frames from values and rates there."""
    ends = 0.5 * spacing * (value[1:] + value[:-1])
    return np.asarray(ends + spacing**2 / 12.0 * (rate[:-1] - rate[1:]))
