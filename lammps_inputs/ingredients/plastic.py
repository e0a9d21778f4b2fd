"""Contacts that yield: from a yield strength in SI units, or from the overlap at yield; or of a constant restitution.

The parts of a scene that name them, `material` and `contact`, ask here for their law and for what it excludes.

The contact of two spheres yields where the pressure in its middle reaches 1.6 times the yield strength (of the softer):
at the overlap ``delta_y = (pi sigma_0 / (2 E*))^2 R*``, with the pressure ``sigma_0 = 1.6 sigma_y`` (Thornton 1997;
Johnson, Contact Mechanics, 1985, 6.1).
"""

import math
from collections.abc import Callable
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Positive, ScenePart, Setting, Solids
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.plastic import YIELD_PRESSURE, Thornton, WaltonBraun
from lammps_inputs.numbers import number_or_array
from lammps_inputs.units import PURE, Label, Unit

SOURCES: dict[str, tuple[str, ...]] = {"thornton": ("thornton1997",), "walton-braun": ("walton1986",)}
"""Publications of the laws."""


WHY = {
    Fact.FRONT: "unloading waves run faster than the front, past a window",
    Fact.REVERSIBLE: "suzuki4 steps back in time within each cycle",
    Fact.FRAMES: "contacts that yield are not known",
}
"""Facts that do not hold where contacts yield, each with a clause for users whose scene needs the fact."""

SMALLEST = 1e-6
"""Smallest dimensionless overlap at yield."""


class Yield(ScenePart):
    """Contacts that yield, by the law of their author."""

    example: ClassVar[str] = "{overlap: 0.1}"

    law: Literal["thornton", "walton-braun"] = "thornton"
    """Law: elastic, perfectly plastic spheres, or two straight lines with a restitution that no velocity changes."""
    overlap: Annotated[Annotated[Positive, Unit("m")] | None, Label("overlap at yield", "\\delta_y")] = None
    """Overlap at which the contact of two reference beads yields (`thornton`)."""
    restitution: Annotated[
        Annotated[float, Field(ge=0.01, le=1), PURE] | None, Label("restitution of contacts that yield", "e")
    ] = None
    """Restitution of two beads (`walton-braun`)."""

    @property
    def linear(self) -> bool:
        """Whether the contacts are straight lines."""
        return self.law == "walton-braun"

    def refuse(self, setting: Setting) -> None:
        """Refuse keys of the other law, and what is not known of contacts that yield.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        wanted, other = ("restitution", "overlap") if self.linear else ("overlap", "restitution")
        example = "{law: walton-braun, restitution: 0.8}" if self.linear else self.example
        if getattr(self, other) is not None:
            raise ValueError(f"contact.yield.{other}: is no key of the law {self.law}; valid: `yield: {example}`")
        if getattr(self, wanted) is None:
            raise ValueError(f"contact.yield.{wanted}: is missing; valid: `yield: {example}`")
        if self.overlap is not None:
            refuse_at_once("contact.yield.overlap", self.overlap / setting.scale.length)
        refuse(setting, of_spheres=not self.linear)

    def law_of(self, setting: Setting, strength: Parameter, solids: Callable[[], Solids]) -> Law:
        """The dimensionless law of contacts of solids (`Ingredient.law_between`)."""
        if self.linear:
            assert self.restitution is not None
            return WaltonBraun(strength, self.restitution)
        assert self.overlap is not None
        return law_of_spheres(self.overlap / setting.scale.length, strength, solids())


def refuse_at_once(key: str, onset: float, hint: str = "") -> None:
    """Refuse a dimensionless overlap at yield that is too small for forces to be resolved.

    Raises:
        ValueError: naming the key.
    """
    if not onset >= SMALLEST:
        raise ValueError(
            f"{key}: contacts yield at once, at an overlap of {onset:.3g} in dimensionless units; at least "
            f"{SMALLEST:g}{hint}"
        )


def refuse(setting: Setting, *, of_spheres: bool) -> None:
    """Refuse what is not known of contacts that yield.

    Args:
        setting: the scene.
        of_spheres: whether they yield as spheres do.

    Raises:
        ValueError: naming the key, what was found and what to do.
    """
    damping = setting.part("damping")
    if damping is not None and damping.contact:
        raise ValueError("damping.contact: contacts that yield have no dashpots; leave one of them out")
    for side in ("left", "right"):
        wall = getattr(setting.part("walls"), side, None)
        stiffness = None if wall is None or isinstance(wall, str) else wall.stiffness
        if stiffness is not None and of_spheres:
            raise ValueError(
                f"walls.{side}.stiffness: the overlap at which such a wall yields is not known; take bead, flat, rigid "
                "or {material: ...}"
            )


def law_of_spheres(onset: float, strength: Parameter, solids: Solids) -> Thornton:
    """The dimensionless law of contacts of spheres that yield.

    Args:
        onset: overlap at which two reference beads yield, dimensionless.
        strength: strength over that of two reference beads.
        solids: what is in contact.
    """
    ratio = np.asarray(solids.softer) / solids.modulus
    return Thornton(strength, number_or_array(onset * solids.radius * ratio * ratio))


def overlap_at_yield(radius: float, youngs_modulus: float, poisson_ratio: float, strength: float) -> float:
    """Overlap (m) at which two equal beads yield, from their radius (m), moduli and yield strength (Pa)."""
    modulus = youngs_modulus / (2.0 * (1.0 - poisson_ratio**2))
    return float((math.pi * YIELD_PRESSURE * strength / (2.0 * modulus)) ** 2 * 0.5 * radius)
