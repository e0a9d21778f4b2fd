"""Contacts that yield: from a yield strength in SI units, or from the overlap at yield; or of a constant restitution.

The contact of two spheres yields where the pressure in its middle reaches 1.6 times the yield strength (of the softer):
at the overlap ``delta_y = (pi sigma_0 / (2 E*))^2 R*``, with the pressure ``sigma_0 = 1.6 sigma_y`` (Thornton 1997;
Johnson, Contact Mechanics, 1985, 6.1).
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from lammps_inputs import laws
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Positive, ScenePart, Setting
from lammps_inputs.ingredients.material import Material
from lammps_inputs.ingredients.unequal import sizes_and_moduli, yield_strengths
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.plastic import YIELD_PRESSURE, Thornton, WaltonBraun
from lammps_inputs.numbers import number_or_array
from lammps_inputs.units import PURE, Label, Unit

SOURCES = {"thornton": ("thornton1997",), "walton-braun": ("walton1986",)}
"""Publications of the laws."""


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

    def refuse(self) -> None:
        """Refuse keys of the other law.

        Raises:
            ValueError: naming the key.
        """
        wanted, other = ("restitution", "overlap") if self.linear else ("overlap", "restitution")
        example = "{law: walton-braun, restitution: 0.8}" if self.linear else self.example
        if getattr(self, other) is not None:
            raise ValueError(f"contact.yield.{other}: is no key of the law {self.law}; valid: `yield: {example}`")
        if getattr(self, wanted) is None:
            raise ValueError(f"contact.yield.{wanted}: is missing; valid: `yield: {example}`")


def given(setting: Setting) -> Yield | None:
    """Law of contacts that yield by `contact.yield`; None where the scene names none."""
    contact = setting.part("contact")
    return None if contact is None else contact.yields


def key(setting: Setting) -> str:
    """Key that makes contacts yield; empty where none does."""
    if setting.material is not None and setting.material.yield_strength is not None:
        return "material.yield_strength"
    return "contact.yield" if given(setting) is not None else ""


def refuse(setting: Setting, scheme: str | None, *, forces_of_some: bool) -> None:
    """Refuse what is not known of contacts that yield.

    Args:
        setting: the scene.
        scheme: its integration scheme; None for the default.
        forces_of_some: whether forces are evaluated where not all beads are recorded.

    Raises:
        ValueError: naming the key, what was found and what to do.
    """
    named, yields = key(setting), given(setting)
    strengths = {f"kinds.{name}": kind for name, kind in (setting.part("kinds") or {}).items()}
    striker = setting.part("striker")
    strengths |= {} if striker is None else {"striker": striker}
    ball = setting.material
    for place, kind in strengths.items():
        other = kind.material is not None or kind.youngs_modulus is not None
        if kind.yield_strength is not None and (ball is None or ball.yield_strength is None):
            raise ValueError(f"{place}.yield_strength: needs `material.yield_strength`, too")
        if ball is not None and ball.yield_strength is not None and other and kind.yield_strength is None:
            raise ValueError(
                f"{place}.yield_strength: is missing beside material.yield_strength; a number (Pa) or catalogue"
            )
    if not named:
        return
    if yields is not None:
        yields.refuse()
        if named != "contact.yield":
            raise ValueError("contact.yield: material.yield_strength makes the contacts yield; leave one of them out")
    contact = setting.part("contact")
    if yields is None and (setting.contact_scale[0] != 1.5 or (contact is not None and contact.force is not None)):
        raise ValueError(f"contact: other contacts than spheres, which alone yield by {named}; leave one of them out")
    reference = overlap_at_yield(ball) if yields is None else yields.overlap
    if reference is not None and not reference / setting.scale.length >= SMALLEST:
        place, meant = ("contact.yield.overlap", "") if yields is not None else (named, "; is it in Pa?")
        raise ValueError(
            f"{place}: contacts yield at once, at an overlap of {reference / setting.scale.length:.3g} in "
            f"dimensionless units; at least {SMALLEST:g}{meant}"
        )
    if setting.part("window") is not None:
        raise ValueError(f"{named}: unloading waves run faster than the front, past a window; leave the window out")
    if scheme not in (None, "verlet"):
        raise ValueError(f"{named}: {scheme} steps back in time within each cycle; leave the scheme out")
    damping = setting.part("damping")
    if damping is not None and damping.contact:
        raise ValueError("damping.contact: contacts that yield have no dashpots; leave one of them out")
    if forces_of_some:
        raise ValueError("output.beads: frames of all beads hold the memory on which forces depend; leave it out")
    for side in ("left", "right"):
        wall = getattr(setting.part("walls"), side, None)
        stiffness = None if wall is None or isinstance(wall, str) else wall.stiffness
        if stiffness is not None and not (yields is not None and yields.linear):
            raise ValueError(
                f"walls.{side}.stiffness: the overlap at which such a wall yields is not known; take bead, flat, rigid "
                "or {material: ...}"
            )


def law_of(setting: Setting, strength: Parameter, size: Parameter, modulus: Parameter, softer: Parameter) -> Law:
    """The dimensionless law of contacts that yield.

    Args:
        setting: the scene that names them.
        strength: strength over that of two reference beads.
        size, modulus: radius and plane modulus of two equal beads whose contact it is, in the reference bead's.
        softer: lower yield strength of the two, in the reference bead's.
    """
    yields = given(setting)
    if yields is not None and yields.linear:
        assert yields.restitution is not None
        return WaltonBraun(strength, yields.restitution)
    reference = yields.overlap if yields is not None else overlap_at_yield(setting.material)
    assert reference is not None
    ratio = np.asarray(softer) / modulus
    onset = reference / setting.scale.length * size * ratio * ratio
    return Thornton(strength, number_or_array(onset))


def overlap_at_yield(ball: Material | None) -> float | None:
    """Overlap at which two reference beads yield (m)."""
    if ball is None or ball.yield_strength is None:
        return None
    modulus = ball.youngs_modulus / (2.0 * (1.0 - ball.poisson_ratio**2))
    return (math.pi * YIELD_PRESSURE * ball.yield_strength / (2.0 * modulus)) ** 2 * 0.5 * ball.radius


def taken_away(setting: Setting, law: Law) -> frozenset[Fact]:
    """Facts that do not hold where the force of contacts depends on the past; none for other laws.

    Raises:
        ValueError: a law of one's own is incomplete.
    """
    laws.refuse_incomplete(law)
    if not laws.has_state(law):
        return frozenset()
    facts = {Fact.FRAMES, Fact.ENERGY, Fact.FRONT, Fact.REVERSIBLE}
    return frozenset(facts if key(setting) else {*facts, Fact.MOMENTUM})


def between(setting: Setting, strength: Parameter) -> Law | None:
    """Law of the contacts between beads; None where they do not yield."""
    if not key(setting):
        return None
    soft = yield_strengths(setting)
    size, modulus = sizes_and_moduli(setting)
    if not isinstance(soft, float):
        soft = np.minimum(soft[:, :-1], soft[:, 1:])
    return law_of(setting, strength, size, modulus, soft)
