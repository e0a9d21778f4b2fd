"""Walls of a user's deck: where each begins to push a bead at the end of a chain, and the law of its force.

All beads are moved by one distance towards a wall, so that contacts and springs between chains stay as they are. A
wall that is further away than the next bead would be, or that has another law than the contacts, is none of a scene;
whether that matters, the run beside the deck shows.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Floats = NDArray[np.float64]

MOST_DISTANCES = 200
"""Distances at which a wall is looked for, each one radius further."""

LEVELS = (1.0, 2.0, 4.0)

_ALIKE = 1e-4
"""Relative deviation of forces, below which they are a power of the overlap."""


@dataclass(frozen=True)
class WallLaw:
    """Law of the wall at one end of all chains, in the deck's units.

    Attributes:
        side: "left" or "right", the ends in the order in which the axis has them.
        clearance: distance of each chain's last bead from the wall, negative where it is pressed, [chain].
        strength: force over overlap to the power `exponent`, [chain].
        exponent: exponent of the overlap.
        dashpot: ratio of dashpot force and velocity at the overlaps `dashpot_overlap`, [2, chain].
        dashpot_overlap: [2].
    """

    side: str
    clearance: Floats
    strength: Floats
    exponent: float
    dashpot: Floats
    dashpot_overlap: Floats


WallPush = Callable[[float, float], Floats]
"""Force of a wall on the beads at an end, [chain], all beads moved towards it by a distance, with a velocity."""

Noise = Callable[[float], float]


class Reach(NamedTuple):
    """How far, and how finely, a wall is looked for.

    Attributes:
        small: overlap at which laws are measured first.
        radius: smallest radius, the step of the search.
        farthest: largest distance by which the beads can be moved.
    """

    small: float
    radius: float
    farthest: float


def wall_law(side: str, push: WallPush, reach: Reach, noise: Noise, exponent: float, speed: float) -> "WallLaw | None":
    """Law of the wall at an end where beads are not pressed; None where no wall is within reach.

    Args:
        side: "left" or "right".
        push: force of the wall.
        reach: how far a wall is looked for.
        noise: force of the size of rounding at a distance, as a function of it.
        exponent: exponent of the contacts.
        speed: velocity at which dashpots are measured.
    """
    small, radius, farthest = reach
    if farthest <= small:
        return None
    distances = np.append(np.arange(small, farthest, radius)[:MOST_DISTANCES], farthest)
    touched = next((k for k, d in enumerate(distances) if np.max(push(d, 0.0)) > noise(d)), None)
    if touched is None:
        return None
    near, behind = float(distances[touched - 1]) if touched else 0.0, float(distances[touched])
    while behind - near > 1e-3 * small:
        middle = 0.5 * (near + behind)
        near, behind = (near, middle) if np.max(push(middle, 0.0)) > noise(middle) else (middle, behind)
    levels = [level * small for level in LEVELS]
    forces = np.array([push(near + level, 0.0) for level in levels])
    fitted = [_power(of_chain, np.array(levels), exponent, small) for of_chain in forces.T]
    strength, power, correction = (np.array(values) for values in zip(*fitted, strict=True))
    overlaps = np.array([levels[0], levels[2]])
    dashpot = wall_dashpot(push, near - float(np.nanmax(correction)) + overlaps, speed)
    return WallLaw(side, near - correction, strength, float(np.nanmax(power)), dashpot, overlaps)


def wall_dashpot(push: WallPush, distances: Floats, speed: float) -> Floats:
    """Ratio of dashpot force and velocity, [distance, chain], of beads that move towards a wall."""
    return np.array([(push(distance, speed) - push(distance, 0.0)) / speed for distance in distances.tolist()])


def _power(forces: Floats, overlaps: Floats, exponent: float, small: float) -> tuple[float, float, float]:
    """Constant, exponent, and how much larger overlaps are, of forces at three nearly known overlaps; NaN without."""
    if not np.all(forces > 0.0):
        return math.nan, math.nan, math.nan

    def ratio(more: float) -> float:
        return float(((overlaps[1] + more) / (overlaps[0] + more)) ** exponent - forces[1] / forces[0])

    low, high = -0.5 * small, 0.5 * small
    if ratio(low) * ratio(high) < 0.0:
        more = float(brentq(ratio, low, high, xtol=1e-16))
        constants = forces / (overlaps + more) ** exponent
        if np.ptp(constants) <= _ALIKE * constants[0]:
            return float(constants[0]), exponent, more
    power = math.log(forces[2] / forces[1]) / math.log(overlaps[2] / overlaps[1])
    return float(forces[2] / overlaps[2] ** power), power, 0.0
