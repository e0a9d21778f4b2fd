"""Times, displacements or velocities of a trajectory that are multiples of those of the scene: other units, or steps.

Displacements change by the integrals of the velocities whatever the forces are: a factor between the two belongs to
one of times, displacements and velocities. Which of them, the forces of the scene show: with the right one divided by
the factor, the momentum equations hold. Where the factor is 1, two of the three may have one factor, which the
velocities at the start show.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from analysis.compare.momentum import MomentumEquations
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import physics

LEAST = 1e-4
"""Difference of a factor from 1 that is looked for."""

LEFT = 0.1
"""Share of what the forces leave unexplained that may be left with the right factor."""

_NOISE = 3.0

_STEADY = 5.0
"""Difference of a factor from 1, over the difference between the factors of both halves of the frames, at least."""

_ROUNDING = 1e-9
"""Least relative uncertainty of a factor."""

_WEIGHTS = np.array([-1.0, 13.0, 13.0, -1.0]) / 24.0
"""Integral from the second to the third of four values, over their distance, by the cubic polynomial through them."""


@dataclass(frozen=True)
class ScaleFactor:
    """What of a trajectory is a multiple of what it would be in the scene's units.

    Attributes:
        quantity: "times", "displacements", "velocities", "times and velocities" or "displacements and velocities".
        factor: numbers of the trajectory over the right ones; of times, where velocities are divided by it.
        uncertainty: of the factor.
    """

    quantity: str
    factor: float
    uncertainty: float


def scale_factor(trajectory: Trajectory, reference: Trajectory) -> ScaleFactor | None:
    """Factor that explains why a trajectory does not follow the forces of its scene; None if none does.

    Args:
        trajectory: consecutive frames of all atoms, evenly spaced.
        reference: the same frames as the scene has them.
    """
    if trajectory.frames < len(_WEIGHTS) + 1 or not np.any(trajectory.velocity):
        return None
    factor, uncertainty = _displaced_over_moved(trajectory)
    right, _ = _displaced_over_moved(reference)
    if right == 0.0:  # a reference whose beads are not displaced as they move says nothing of scales
        return None
    factor, uncertainty = factor / right, uncertainty / abs(factor) + abs(right - 1.0) * LEFT if factor else 1.0
    differs = abs(factor - 1.0) > max(LEAST, _STEADY * uncertainty * abs(factor))
    candidates = list(_of_one(trajectory, factor) if differs else _of_two(trajectory))
    if not candidates:
        return None
    noise, actual = _unexplained(reference), _unexplained(trajectory)
    if actual <= _NOISE * noise:
        return None
    shares = [(_unexplained(corrected), quantity, value) for quantity, value, corrected in candidates]
    left, quantity, value = min(shares)
    if left > max(_NOISE * noise, LEFT * actual) or left > LEFT:
        return None
    return ScaleFactor(quantity, value, max(uncertainty, _ROUNDING) * abs(value))


def _displaced_over_moved(trajectory: Trajectory) -> tuple[float, float]:
    """Changes of displacements over integrals of velocities, by least squares; difference of both halves' factors."""
    x, v = trajectory.displacement, trajectory.velocity
    spacing = (trajectory.time[-1] - trajectory.time[0]) / (trajectory.frames - 1)
    count = trajectory.frames - len(_WEIGHTS) + 1
    moved = spacing * sum(weight * v[k : k + count] for k, weight in enumerate(_WEIGHTS.tolist()))
    displaced = (x[2:-1] - x[1:-2]).reshape(count, -1)
    moved = np.asarray(moved).reshape(count, -1)
    product, power = np.sum(displaced * moved, axis=1), np.sum(moved * moved, axis=1)
    half = 1 + int(np.searchsorted(np.cumsum(power), 0.5 * np.sum(power)))
    overall, *halves = (
        float(np.sum(product[part]) / max(float(np.sum(power[part])), np.finfo(float).tiny))
        for part in (slice(None), slice(half), slice(min(half, count - 1), None))
    )
    return overall, max(abs(part - overall) for part in halves)


Candidate = tuple[str, float, Trajectory]


def _of_one(trajectory: Trajectory, factor: float) -> Iterator[Candidate]:
    """Times, displacements or velocities with a factor, each with the trajectory without it."""
    if factor > 0.0:
        yield "times", 1.0 / factor, replace(trajectory, time=trajectory.time * factor)
    yield "displacements", factor, _with(trajectory, 1.0 / factor, 1.0)
    yield "velocities", 1.0 / factor, _with(trajectory, 1.0, factor)


def _of_two(trajectory: Trajectory) -> Iterator[Candidate]:
    """Two of the three with a factor, by the velocities at the start."""
    right = physics.initial_velocity(trajectory.problem.system)[:, trajectory.beads - 1]
    moving = right != 0.0
    if trajectory.time[0] != 0.0 or not np.any(moving):
        return
    factors: Floats = trajectory.velocity[0][moving] / right[moving]
    factor = float(factors[0])
    if np.ptp(factors) > LEAST * abs(factor) or not factor > 0.0 or abs(factor - 1.0) <= LEAST:
        return
    yield "displacements and velocities", factor, _with(trajectory, 1.0 / factor, 1.0 / factor)
    yield (
        "times and velocities",
        1.0 / factor,
        replace(_with(trajectory, 1.0, 1.0 / factor), time=trajectory.time * factor),
    )


def _with(trajectory: Trajectory, of_displacement: float, of_velocity: float) -> Trajectory:
    """A trajectory with displacements and velocities times these factors."""
    x, v = trajectory.atoms
    return trajectory.with_motion(trajectory.time, of_displacement * x, of_velocity * v)


def _unexplained(trajectory: Trajectory) -> float:
    """Share of the changes of momentum that the forces of the scene leave, root mean square."""
    with np.errstate(over="ignore", invalid="ignore"):
        equations = MomentumEquations(trajectory)
        share = float(np.linalg.norm(equations.residual)) / equations.size
    return share if np.isfinite(share) else np.inf
