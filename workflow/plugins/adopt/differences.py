"""What of a user's deck a scene cannot have: walls elsewhere or of other laws, and forces that are not the scene's.

Forces are compared pair by pair and wall by wall, at the displacements and velocities at which they were measured
(`ForceProbe`), with those of the scene's equations.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from granchain import Scene
from granchain.parts import dashpot, motion, physics
from workflow.plugins.adopt.chains import Measured
from workflow.plugins.adopt.wall_laws import WallLaw

Floats = NDArray[np.float64]

ALIKE = 1e-5
"""Relative difference of forces that is that of their measurement."""

LEAST = 1e-6
"""Forces over the largest that are rounding."""

MOST = 3
"""Pairs or walls that are named."""

_WALLS = "supported: walls as far from the chains as the beads are from each other, with the law of the contacts"


def of_walls(measured: Measured, scene: Scene) -> list[str]:
    """Sentences on walls that are not those of the scene, in the deck's units."""
    sentences = [f"{text}; {_WALLS}" for wall in measured.other_walls for text in _other_wall(wall, measured)]
    return sentences + [
        f"{text}; {_WALLS}" for side in measured.walls for text in _other_dashpot(side, measured, scene)
    ]


def unreached(measured: Measured) -> list[str]:
    """Notes on walls that are no part of the scene, where the run beside the deck does not show them."""
    return [
        f"the {wall.side} wall, {np.nanmin(wall.clearance):.6g} from the chain, is left out: no bead reaches it in the "
        "compared steps"
        for wall in measured.other_walls
    ]


def _other_wall(wall: WallLaw, measured: Measured) -> Iterator[str]:
    gap = max(0.0, -float(np.min(measured.overlap)))
    clearance = float(wall.clearance[int(np.nanargmax(np.abs(wall.clearance - gap)))])
    if np.any(np.isnan(wall.clearance)) or np.ptp(wall.clearance) > 1e-6 * float(np.min(measured.radius)):
        yield f"the {wall.side} wall is not at the same distance from all chains"
    elif abs(clearance - gap) > 1e-6 * float(np.min(measured.radius)):
        yield f"the {wall.side} wall is {clearance:.6g} from the chain, where beads are {gap:.6g} apart"
    if abs(wall.exponent - measured.exponent) > 1e-3:
        yield (
            f"the force of the {wall.side} wall grows as overlap^{wall.exponent:.4g}, that of the contacts as "
            f"overlap^{measured.exponent:g}"
        )


def _other_dashpot(side: str, measured: Measured, scene: Scene) -> Iterator[str]:
    """Sentence on the dashpot of a wall that stands where a bead would, if it is not what the scene has there."""
    if side not in measured.wall_dashpot or np.any(measured.load > 0.0):
        return
    end = 0 if side == "left" else -1
    actual, overlap = measured.wall_dashpot[side], measured.dashpot_overlap[:, :, end]
    if not np.any(measured.dashpot):
        overlap = np.ones_like(actual)
    right = _dashpot_of_scene(side, measured, scene, overlap)
    if np.any(np.abs(actual - right) > 1e-4 * np.max(np.abs(actual) + np.abs(right)) + 1e-12):
        yield (
            f"the dashpot of the {side} wall is {actual[-1, 0]:.4g} (force over velocity, at an overlap of "
            f"{overlap[-1, 0]:.3g}), where one with the law of the contacts has {right[-1, 0]:.4g}"
        )


def _dashpot_of_scene(side: str, measured: Measured, scene: Scene, overlap: Floats) -> Floats:
    """Ratio of dashpot force and velocity, [2, chain], that a wall of the scene has at overlaps of this shape."""
    damping = scene.part("damping")
    if damping is None or not damping.contact:
        return np.zeros_like(overlap)
    end, unit = (0 if side == "left" else -1), measured.mass.flat[0] / np.ravel(physics.masses(scene.system))[0]
    unit = 1.0 if scene.scale.si else unit
    strength = measured.walls[side]
    if damping.law == "restitution":
        critical = np.sqrt(measured.mass[:, end] * strength)
        return np.asarray(
            dashpot.alpha(damping.contact, measured.exponent) * critical * overlap ** ((measured.exponent - 1.0) / 2.0)
        )
    coefficient = damping.contact * unit
    if damping.law == "viscoelastic":
        reference = float(scene.scale.force / scene.scale.length**measured.exponent) * (1.0 if scene.scale.si else unit)
        return np.asarray(coefficient * strength / reference * np.sqrt(overlap))
    return np.full_like(overlap, coefficient)


def of_forces(measured: Measured, scene: Scene) -> list[str]:
    """Sentences on the pairs and walls whose forces are not the scene's, where they differ most, most first."""
    problem = scene.problem()
    system, scale = problem.system, problem.scale
    chains, of_line = system.chains, system.chain_of_line  # atoms inside the beads move with them
    overall = max(float(np.max(np.abs(probe.force))) for probe in measured.probes)
    worst: dict[tuple[int, int], tuple[float, str]] = {}
    for probe in measured.probes:
        x, v = probe.displacement[of_line] / scale.length, probe.velocity[of_line] / scale.velocity
        moved, at_rest = (
            motion.acceleration(system, displacement, velocity=velocity)[:chains]
            for displacement, velocity in ((x, v), (0.0 * x, 0.0 * v))
        )
        right = (moved - at_rest) * measured.mass * scale.velocity / scale.time
        largest = max(float(np.max(np.abs(np.concatenate([right, probe.force])))), LEAST * overall)
        off = np.where(measured.driven, 0.0, np.abs(probe.force - right) / largest)
        for chain, bead in np.argwhere(off > ALIKE).tolist():
            text = (
                f"{probe.place(measured, chain, bead)}: force {probe.force[chain, bead]:.6g} on atom "
                f"{measured.ids[chain, bead]}, where the scene that was read has {right[chain, bead]:.6g}"
            )
            if off[chain, bead] > worst.get((chain, bead), (0.0, ""))[0]:
                worst[chain, bead] = (float(off[chain, bead]), text)
    return [text for _, text in sorted(worst.values(), key=lambda entry: -entry[0])[:MOST]]
