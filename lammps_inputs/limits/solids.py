"""Elastic spheres as solids: where Hertz's law ends, and numbers that no bead has.

Hertz's law is that of small, elastic, slow contacts (Johnson, Contact Mechanics, 1985, sections 4.1, 6.1, 11.4). A
scene in SI units may leave its range without any sign in the dimensionless numbers, which know neither radius nor
strength. How far beads overlap is bounded here before a run, with the force and pressure that belong to it.

A number in another unit than SI is off by powers of ten, which the dimensionless problem does not show either. The
limits here are of nature, wide enough for foam, hydrogel, rubber, glass, tungsten carbide and diamond: numbers beyond
some are refused, beyond others they are unlikely, with the unit that was probably meant.
"""

import math
from typing import Any

import numpy as np

from lammps_inputs import laws, physics
from lammps_inputs.facts import Fact
from lammps_inputs.laws import Law
from lammps_inputs.system import System

FASTEST_SOUND = 36.1e3
"""m/s. No solid or liquid has a faster sound: ``alpha sqrt(m_e / 2 m_p) c`` (Trachenko, Monserrat, Pickard & Brazhkin,
Science Advances 6, eabc8662, 2020). In a thin bar of diamond it is half of that.
"""

AIR = 1.2
"""kg/m3. A solid that is lighter would rise in it."""

OSMIUM = 22_590.0
"""kg/m3, the densest element."""

HEAVIEST = 1e5
"""kg/m3. Spheres that carry something else may be denser than osmium, but hardly four times."""

GRAVITY = 9.81
"""m/s2. A sphere does not keep its shape where the pressure of its weight exceeds its modulus."""

DIAMOND = 1.3e12
"""Pa, a little above the stiffest solids."""

GEL = 1e3
"""Pa, of soft gels."""

STIFF, DENSE = 1e9, 2300.0
"""Pa and kg/m3. Solids denser than polymers are stiffer than this, but for rubber that is filled with metal."""

FOAM = 10.0
"""kg/m3, of the lightest foams."""

LARGE = 0.5
"""m, a metal bead of four tons."""


def impossible(radius: float, density: float, youngs_modulus: float) -> str:
    """Key of a number that no solid sphere has, and why, with the unit that was probably meant; empty if one may.

    Args:
        radius: in m.
        density: in kg/m3.
        youngs_modulus: in Pa.
    """
    sound, weight = (youngs_modulus / density) ** 0.5, density * GRAVITY * radius
    light = 1e3 * density < OSMIUM
    if density > HEAVIEST:
        return f"density: {density:g} kg/m3 is more than that of any solid (osmium: {OSMIUM:g} kg/m3)"
    if density < AIR:
        return f"density: {density:g} kg/m3 is less than that of air ({AIR:g} kg/m3); {_in_grams(density)}"
    if sound > FASTEST_SOUND:
        why = f"sqrt(youngs_modulus / density) = {sound:.3g} m/s; sound in solids is below {FASTEST_SOUND:g} m/s"
        return f"density: {why}; {_in_grams(density)}" if light else f"youngs_modulus: {why}; is it in Pa?"
    if weight > youngs_modulus:
        why = f"{youngs_modulus:g} Pa is less than a bead's weight exerts, density * 9.81 * radius = {weight:.3g} Pa"
        return f"youngs_modulus: {why}; youngs_modulus in Pa? {_in_gigapascals(youngs_modulus)}"
    return ""


def unlikely(radius: float, density: float, youngs_modulus: float) -> list[str]:
    """Unlikely constants of a bead, each with its value if another unit was meant; arguments as of `impossible`."""
    warnings = []
    if youngs_modulus < GEL:
        why = f"{youngs_modulus:g} Pa is softer than gels ({GEL:g} Pa); {_in_gigapascals(youngs_modulus)}"
        warnings.append(f"youngs_modulus in Pa? {why}")
    elif youngs_modulus < STIFF and density > DENSE:
        meant = f"{youngs_modulus:g} MPa is {1e6 * youngs_modulus:g} Pa"
        if 1e9 * youngs_modulus < DIAMOND:
            meant = _in_gigapascals(youngs_modulus)
        warnings.append(f"youngs_modulus in Pa? {youngs_modulus:g} Pa is soft for {density:g} kg/m3; {meant}")
    elif youngs_modulus > DIAMOND:
        warnings.append(f"youngs_modulus in Pa? {youngs_modulus:g} Pa is stiffer than diamond")
    if density < FOAM:
        warnings.append(f"density in kg/m3? {density:g} kg/m3 is lighter than foam; {_in_grams(density)}")
    elif density > OSMIUM:
        warnings.append(f"density in kg/m3? {density:g} kg/m3 is more than that of osmium")
    if radius > LARGE:
        warnings.append(f"radius in m? {radius:g} m is large for a bead; {radius:g} mm is {1e-3 * radius:g} m")
    return warnings


def _in_gigapascals(youngs_modulus: float) -> str:
    return f"{youngs_modulus:g} GPa is {1e9 * youngs_modulus:g} Pa"


def _in_grams(density: float) -> str:
    return f"{density:g} g/cm3 is {1e3 * density:g} kg/m3"


LARGEST_OVERLAP = 0.1
"""Over the radius. The contact's radius is then 0.22 of the bead's, and Hertz asks for a small one (Johnson, 4.1)."""

FLATTENED = 1.0
"""Overlap over the radius from which on a motion is none of elastic spheres: each has lost half of its radius."""


def is_of_spheres(law: Law) -> bool:
    """Whether a contact is one of elastic spheres."""
    return law.exponent is not None and np.ndim(law.exponent) == 0 and law.exponent == 1.5


def sound_speed(youngs_modulus: float, density: float) -> float:
    """Speed of sound in a thin bar, ``sqrt(E / rho)`` (m/s): the slowest wave of compression in the material."""
    return math.sqrt(youngs_modulus / density)


def peak_pressure(overlap: Any, radius: float, youngs_modulus: float, poisson_ratio: float) -> Any:
    """Pressure in the middle of a contact (Pa): ``2 E* a / (pi R*)`` with ``a**2 = R* overlap`` (Johnson, eq. 4.22-24).

    For equal spheres that is ``E / (pi (1 - nu**2)) sqrt(2 overlap / R)``.

    Args:
        overlap: approach of the centres (m), a number or an array.
        radius: of the beads (m).
        youngs_modulus: E (Pa).
        poisson_ratio: nu.
    """
    return youngs_modulus / (math.pi * (1.0 - poisson_ratio**2)) * np.sqrt(2.0 * overlap / radius)


def overlap_bounds(system: System) -> tuple[float, float]:
    """Bounds from below and above on the largest overlap of a run that lasts long enough; dimensionless.

    From above: beads that belong together (one chain, or all of them with springs) keep their energy, and what their
    centre of mass carries cannot be stored: ``U(overlap) <= E - P**2 / (2 M)``, where U is the energy of a contact (for
    spheres ``0.4 overlap**2.5``). Two beads reach that.

    From below: a contact is opposed by its own force alone, for both neighbours press it together, and by springs,
    whose pull on its two beads, s, their energy bounds. So where beads set out at a closing speed w, the overlap where
    they come to rest is no less than the root of ``2 U(overlap) + s (overlap + gap) = w**2 / 2``.

    Under a static load: the overlap at rest, and that with what energy can add to it. Beads that differ, or that other
    springs hold too, get the bound from above by the whole energy, and the overlap at the start from below.
    """
    law = system.along[0].law
    at_start = 0.0
    if system.start is not None:
        x = system.start.displacement[: system.chains]
        at_start = max(0.0, *(float(np.max(link.overlap(x))) for link in system.contacts))
    if physics.loaded(system):
        rest = law.rest
        return max(at_start, float(np.max(rest))), float(np.max(rest + law.max_strain(physics.energy(system), *law)))
    as_reference = bool(np.all(np.equal(laws.strength(law), 1.0)))
    if not (as_reference and physics.simply_coupled(system) and system.holds(Fact.MOMENTUM)):
        return at_start, max(laws.max_strain(link.law, physics.energy(system)) for link in system.contacts)
    chains, beads, kappa, coupled = system.chains, system.beads, physics.kappa(system), physics.coupled(system)
    velocities = {(chain, bead): velocity for chain, bead, velocity in system.kicks}
    groups: dict[int, list[float]] = {}
    for (chain, _), velocity in velocities.items():
        groups.setdefault(0 if coupled else chain, []).append(velocity)
    mass = float(beads * chains if coupled else beads)
    storable = max(
        0.5 * sum(velocity**2 for velocity in group) - 0.5 * sum(group) ** 2 / mass for group in groups.values()
    )
    closing = 0.0
    for chain, bead in velocities:
        for left in (bead - 1, bead):
            if 1 <= left < beads:
                speed = velocities.get((chain, left), 0.0) - velocities.get((chain, left + 1), 0.0)
                closing = max(closing, speed)
    # each of the two beads has at most two springs, and n springs of energy E pull with sqrt(2 n kappa E) at most
    springs = min(4, 2 * (chains - 1)) if coupled else 0
    pull = math.sqrt(2.0 * springs * kappa * max(storable, 0.0))
    high = laws.max_strain(law, max(storable, 0.0))
    return min(_comes_to_rest(law, closing, pull, physics.gap(system)), high), high


def _comes_to_rest(law: Law, speed: float, pull: float, gap: float) -> float:
    """Root of ``2 U(overlap) + pull (overlap + gap) = speed**2 / 2``, from below; 0 where there is none."""
    energy = 0.5 * speed**2 - pull * gap
    if not energy > 0.0:
        return 0.0
    low, high = 0.0, laws.max_strain(law, 0.5 * energy)
    if pull == 0.0:
        return high
    for _ in range(60):
        middle = 0.5 * (low + high)
        held = 2.0 * float(laws.energy(law, middle)) + pull * middle
        low, high = (middle, high) if held <= energy else (low, middle)
    return low
