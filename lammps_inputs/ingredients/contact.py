"""Contacts between neighbouring beads of a chain: what every scene has, with or without a gap.

They are those of elastic spheres (Hertz 1882), unless the scene names another exponent. Measured for shells, hollow
spheres, cylinders and rubber O-rings: p from 1 to 3 (Nesterenko 2001; Spadoni & Daraio, PNAS 107, 2010).
"""

from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, create_model, field_validator

from lammps_inputs import strict_yaml
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import plastic, profile
from lammps_inputs.ingredients.base import Ingredient, Positive
from lammps_inputs.ingredients.profile import Strength
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.contact import Hertz, Power
from lammps_inputs.links import Along
from lammps_inputs.units import PURE, Unit

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene
    from lammps_inputs.system import System

HERTZ = 1.5
"""Exponent of the contact of spheres."""

LEAST_OF_PULSES = 1.05
"""Exponent below which a solitary wave, if there is one, is longer than forty beads."""


class _Contact(Ingredient):
    """A force ``stiffness * overlap**exponent``."""

    example: ClassVar[str] = "{exponent: 2}"

    why = MappingProxyType(
        {Fact.REVERSIBLE: "contacts of an exponent below 1.5 open and close so abruptly that suzuki4 gains nothing"}
    )

    exponent: Annotated[float, Field(ge=1, le=3), PURE] = HERTZ
    """Exponent p."""
    stiffness: Annotated[Positive, Unit("N/m^p")] | None = None
    """Constant A. Reduced units: 1 if omitted. With a material: required unless p = 1.5, where the material gives it.
    """
    strength: Strength | None = None
    """Factor on A of each contact: a number, a profile, or a list with one for each contact; 1 if omitted."""

    _from_list = field_validator("strength", mode="before")(strict_yaml.as_tuple)

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse units that do not fit, what is known of spheres only, and profiles that do not fit the chains."""
        if not self.model_fields_set:
            raise ValueError(f"contact: names nothing; valid: `contact: {self.example}`")
        if self._yields is not None and "exponent" in self.model_fields_set and self.exponent != self._power:
            raise ValueError(f"contact.exponent: {self._power:g} with the law {self._yields.law}; leave it out")
        if scene.material is not None and self._power == HERTZ and self.stiffness is not None:
            raise ValueError("contact.stiffness: the material says how stiff contacts of the exponent 1.5 are")
        if scene.material is not None and self._power != HERTZ and self.stiffness is None:
            raise ValueError(f"contact.stiffness: is missing; the force at an overlap of 1 m, in N/m^{self._power:g}")

    @property
    def _yields(self) -> plastic.Yield | None:
        found: plastic.Yield | None = getattr(self, "yield")
        return found

    @property
    def _power(self) -> float:
        """Exponent of first loading."""
        if self._yields is None:
            return self.exponent
        return 1.0 if self._yields.linear else HERTZ

    def refuse_system(self, scene: "BaseScene", system: "System") -> None:  # noqa: ARG002
        """Refuse what is known of spheres only."""
        from lammps_inputs.ingredients.unequal import sizes_and_moduli

        if self._power != HERTZ and any(np.any(np.not_equal(one, 1.0)) for one in sizes_and_moduli(scene)):
            raise ValueError(
                f"contact.exponent: {self._power:g} given; how the contacts of beads of unlike radius or modulus "
                "differ is known for spheres, which have 1.5; let them differ in mass alone"
            )

    def contact_law(self, strength: Parameter) -> Law:
        """Hertz's law where it is that."""
        return Hertz(strength) if self._power == HERTZ else Power(strength, self._power)

    def cited(self) -> tuple[str, ...]:
        """Of the profile, and of a law that yields."""
        law = () if self._yields is None else plastic.SOURCES[self._yields.law]
        return law if self.strength is None else ("chaunsali2018", *law)

    @property
    def strength_key(self) -> str:
        """That of the profile."""
        return "" if self.strength is None else "contact.strength"

    def strengths(self, scene: "BaseScene") -> Parameter:
        """Those of the profile."""
        profile.refuse(self.strength_key, self.strength, scene)
        return profile.strengths(self.strength, scene)

    def contact_scale(self) -> tuple[float, float | None]:
        """By which the contacts have the strength 1."""
        return self._power, self.stiffness

    def lacks(self, scene: "BaseScene") -> frozenset[Fact]:  # noqa: ARG002
        """Linear contacts disperse any pulse; all that are harder at first than spheres begin abruptly."""
        taken = {Fact.REVERSIBLE} if self._power < HERTZ else set()
        return frozenset(taken | {Fact.PULSE} if self._power < LEAST_OF_PULSES else taken)


# `yield` is a word of Python's, so it cannot be written as an attribute
_YIELD: dict[str, Any] = {
    "yield": (
        Annotated[plastic.Yield | None, Field(description="How contacts yield; they are elastic if omitted.")],
        None,
    )
}
if TYPE_CHECKING:
    Contact = _Contact
else:
    Contact = create_model("Contact", __base__=_Contact, __module__=__name__, __doc__=_Contact.__doc__, **_YIELD)


def contacts(gap: float, strength: Parameter = 1.0, law: Law | None = None) -> tuple[Along, ...]:
    """Contacts, which begin to touch a clear distance ``gap`` (in units of L) from rest.

    Args:
        gap: the same everywhere.
        strength: in that of two reference beads, a number or [chain, contact].
        law: theirs; Hertz's of this strength by default.
    """
    return (Along("contacts", law or Hertz(strength), gap=gap),)
