"""Walls of a deck where a scene has them: as far from the chains as the beads are from each other.

A wall that stands elsewhere stands there for beads that are displaced: the places from which displacements are counted
are moved. Between two walls the gaps become equal; beside one wall they stay, and the chain touches the wall if they
differ.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from workflow.plugins.adopt.chains import PLACES, Measured, NotMeasuredError

Floats = NDArray[np.float64]

SAME_PLACE = 1e-6
"""Distance, in units of the smallest radius, that is none."""


def with_other_walls(measured: Measured) -> Measured:
    """Chains with those walls that have the law of the contacts, wherever they stand."""
    taken = [
        wall
        for wall in measured.other_walls
        if np.all(np.isfinite(wall.clearance)) and abs(wall.exponent - measured.exponent) <= 1e-3
    ]
    return replace(
        measured,
        walls=measured.walls | {wall.side: wall.strength for wall in taken},
        wall_dashpot=measured.wall_dashpot | {wall.side: wall.dashpot for wall in taken},
        clearance=measured.clearance | {wall.side: wall.clearance for wall in taken},
        other_walls=[wall for wall in measured.other_walls if wall not in taken],
    )


def fitted(measured: Measured) -> Measured:
    """Chains whose displacements are counted from where a scene's gaps and walls leave the beads.

    Raises:
        NotMeasuredError: there are no such places.
    """
    least = SAME_PLACE * float(np.min(measured.radius))
    gaps, clear = -measured.overlap, measured.clearance
    if not measured.walls or np.max(measured.overlap) > least:
        return measured
    alike = float(np.ptp(gaps)) <= least
    target = float(np.mean(gaps)) if alike else 0.0
    if all(np.max(np.abs(values - target)) <= least for values in clear.values()):
        return measured
    if np.any(measured.driven):
        target = 0.0
    shift = np.zeros_like(measured.place)
    if len(clear) == 2:
        total = np.sum(gaps, axis=1) + clear["left"] + clear["right"]
        target = float(np.mean(total)) / (gaps.shape[1] + 2)
        if np.ptp(total) > least:
            raise _elsewhere("the walls are not equally far apart for all chains")
        shift += (target - clear["left"])[:, np.newaxis]
        shift[:, 1:] += np.cumsum(target - gaps, axis=1)
    elif "left" in clear:
        shift += (target - clear["left"])[:, np.newaxis]
    else:
        shift += (clear["right"] - target)[:, np.newaxis]
    shift[measured.driven] = 0.0
    overlap = measured.overlap - np.diff(shift, axis=1)
    if np.max(overlap) > least or (len(clear) == 2 and np.any(measured.driven)):
        raise _elsewhere("a bead whose motion is given is in the way of other places")
    if np.any(measured.foundation) or measured.inner:
        raise _elsewhere("springs determine where the beads are at rest")
    if measured.coupling and np.max(np.ptp(shift, axis=0)) > least:
        raise _elsewhere("springs between the chains would be stretched")
    probes = [replace(probe, displacement=probe.displacement - shift) for probe in measured.probes]
    return replace(
        measured,
        place=measured.place + shift,
        displacement=measured.displacement - shift,
        overlap=overlap,
        clearance={side: np.full_like(values, target) for side, values in clear.items()},
        probes=probes,
    )


def _elsewhere(why: str) -> NotMeasuredError:
    return NotMeasuredError(
        f"a wall is not as far from the chains as the beads are from each other, and {why}; supported there: walls as "
        "far as the next bead would be",
        "fix wall/gran",
        *PLACES,
    )
