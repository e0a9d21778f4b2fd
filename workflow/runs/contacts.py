"""How hard the beads of an SI scene press on each other, and whether that is still Hertz's law."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from analysis.contacts import OverlapMaxima, overlap_meter
from analysis.quantity import declare, result
from lammps_inputs import Problem, Scene, System, laws, physics
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.unequal import radii, sizes_and_moduli, unlike
from lammps_inputs.laws.plastic import YIELD_PRESSURE
from lammps_inputs.limits import solids
from lammps_inputs.links import Links
from workflow.runs.run_directory import RunDirectory


@result
class LargestContactForce:
    """The largest contact force of a run."""

    measured: bool = declare("whether the frames show it; else the numbers are what energy and momentum allow at most")
    radius: float = declare("radius of the reference bead", "m", symbol="R")
    overlap: float = declare(
        "largest approach of two centres over the radius, or of a bead and a wall; of beads that differ, over their "
        "harmonic mean"
    )
    force: float = declare(
        "largest force in a contact of two beads, or of a bead and a wall, static load included", "N", symbol="F"
    )
    pressure: float = declare("largest pressure in the middle of a contact", "Pa", symbol="\\sigma_0")
    yield_strength: float = declare("least yield strength of the beads with which all contacts stay elastic", "Pa")

    def plain(self) -> dict[str, Any]:
        """Plain data, for ``run.json`` and ``analysis.json``."""
        return asdict(self)

    @property
    def possible(self) -> bool:
        """Whether the overlaps that were seen may be those of elastic spheres."""
        return not (self.measured and self.overlap >= solids.FLATTENED)

    def lines(self) -> list[str]:
        """Lines with overlap, force and pressure, and a warning where Hertz's law ends."""
        verb = "reach" if self.measured else "are at most"
        lines = [
            f"overlaps in contacts {verb} {self.overlap:.2g} of the radius ({self.radius:g} m), their forces "
            f"{self.force:.2g} N, their pressures {self.pressure:.2g} Pa",
            f"contacts stay elastic only if the yield strength is above {self.yield_strength:.2g} Pa, as they yield "
            f"from a pressure of {YIELD_PRESSURE} times it on (Johnson, Contact Mechanics, 1985, 6.1); "
            "`material: {yield_strength: ...}`, a number or `catalogue`, makes them yield",
        ]
        if not self.possible:
            lines.append(
                "elastic spheres cannot overlap so far, so this is not a motion of such beads; are all numbers in SI "
                "units, youngs_modulus in Pa, density in kg/m3, velocities in m/s, forces in N?"
            )
        elif self.overlap > solids.LARGEST_OVERLAP:
            word = "are" if self.measured else "may be"
            lines.append(
                f"overlaps {word} too large for Hertz's law, which holds for contacts small against the beads: below "
                f"about {solids.LARGEST_OVERLAP} of the radius (Johnson, 4.1)"
            )
        return lines


def at_most(scene: Scene) -> LargestContactForce | None:
    """The largest contact force that energy and momentum allow; None without a material or contacts of spheres."""
    system = scene.problem().system
    law = system.along[0].law
    if not _of_spheres(scene, law):
        return None
    high = (
        law.rest + law.max_strain(physics.energy(system), *law)
        if laws.differs(law)
        else solids.overlap_bounds(system)[1]
    )
    at_walls = (link.law for link in system.walls)
    walls = [_of_chains(law.rest + law.max_strain(physics.energy(system), *law), system) for law in at_walls]
    return _contacts(scene, high, walls, measured=False)


def of_overlap(scene: Scene, largest: OverlapMaxima | None) -> LargestContactForce | None:
    """The largest contact force by the frames, or `at_most` where they do not show it; None without a material."""
    if largest is None:
        return at_most(scene)
    beads = np.maximum(largest.value if largest.each is None else largest.each, 0.0)
    return _contacts(scene, beads, [np.maximum(overlap, 0.0) for overlap in largest.walls], measured=True)


def measure(directory: RunDirectory) -> LargestContactForce | None:
    """The largest contact force of a run; None without a material, and for rigid beads.

    Raises:
        InputError: there are no frames.
    """
    if not has_contacts(directory.scene, directory.problem):
        return None
    meter = overlap_meter(directory.problem)
    return of_overlap(directory.scene, None if meter is None else meter.read(directory.blocks()))


def has_contacts(scene: Scene, problem: Problem) -> bool:
    """Whether a run has contacts of spheres, in SI units, which overlap."""
    spheres = all(_of_spheres(scene, link.law) for link in problem.system.along)
    return scene.material is not None and spheres and problem.system.holds(Fact.OVERLAPS)


def _of_spheres(scene: Scene, law: laws.Law) -> bool:
    """Whether contacts are those of the scene's beads as elastic spheres, whose pressure is known."""
    return solids.is_of_spheres(law) and not any(ingredient.strength_key for ingredient in scene.ingredients)


def _contacts(scene: Scene, overlap: Any, walls: Sequence[Any], *, measured: bool) -> LargestContactForce | None:
    """The largest of each number, in all contacts.

    Args:
        scene: what was run.
        overlap: largest of any contact of two beads, or that of each, [chain, contact]; dimensionless.
        walls: largest with each wall, [chain].
        measured: whether frames show them.
    """
    ball = scene.material
    if ball is None:
        return None
    size, modulus = sizes_and_moduli(scene.setting)
    metres = overlap * scene.scale.length / size
    pressures = modulus * solids.peak_pressure(metres, ball.radius, ball.youngs_modulus, ball.poisson_ratio)
    force = float(np.max(laws.whole_force(scene.system.along[0].law, overlap))) * scene.scale.force
    pressure, approach = float(np.max(pressures)), float(np.max(metres)) / ball.radius
    for link, at_wall in zip(scene.system.walls, walls, strict=True):
        of_wall = _at_wall(scene, link, at_wall)
        force, pressure, approach = (max(*pair) for pair in zip((force, pressure, approach), of_wall, strict=True))
    return LargestContactForce(
        measured=measured,
        radius=ball.radius,
        overlap=approach,
        force=force,
        pressure=pressure,
        yield_strength=pressure / YIELD_PRESSURE,
    )


def _at_wall(scene: Scene, link: Links, overlap: Any) -> tuple[float, float, float]:
    """Largest force (N), pressure (Pa) and overlap over the bead's radius at a wall, by the overlaps [chain].

    The pressure in the middle is ``3 F / (2 pi R* overlap)`` (Johnson, eq. 4.22-24). The relative radius R* is half the
    bead's radius where the wall is a bead, else the bead's: walls of which only the stiffness is known count as flat.
    """
    assert scene.material is not None
    (beads, _), *_ = link.ends
    force = laws.whole_force(laws.at(link.law, slice(None), 0), overlap) * scene.scale.force
    of_beads = radii(scene.setting)[:, beads.rows][:, 0] if unlike(scene.setting) else np.ones(len(overlap))
    radius = scene.material.radius * of_beads
    relative = 0.5 * radius if link.curved else radius
    metres = overlap * scene.scale.length
    area = 2.0 * math.pi * relative * metres
    pressure = np.divide(3.0 * force, area, out=np.zeros(len(overlap)), where=area > 0.0)
    return float(np.max(force)), float(np.max(pressure)), float(np.max(metres / radius))


def _of_chains(values: Any, system: System) -> Any:
    """Values at walls, a number or [chain, 1], as [chain]."""
    return np.broadcast_to(values, (system.chains, 1))[:, 0]
