"""Contacts of one exponent: those of spheres, unless the scene names another.

Measured for shells, hollow spheres, cylinders and rubber O-rings: p from 1 to 3 (Nesterenko 2001; Spadoni & Daraio,
PNAS 107, 2010).
"""

from typing import Annotated, ClassVar

from pydantic import Field

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Positive, Setting
from lammps_inputs.ingredients.contact import HERTZ, MOST_EXPONENT, Contact, Strength, lacking, of_power
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.units import PURE, Label, Unit

Exponent = Annotated[float, Field(ge=1, le=MOST_EXPONENT), PURE]


class PowerContact(Contact):
    """A force ``stiffness * overlap**exponent``."""

    key: ClassVar[str] = "exponent"
    noun: ClassVar[str] = "contacts of one exponent"

    exponent: Annotated[Exponent, Label("contact exponent", "p")] = HERTZ
    """Exponent p."""
    stiffness: Annotated[Annotated[Positive, Unit("N/m^p")] | None, Label("contact constant", "A")] = None
    """Constant A. Reduced units: 1 if omitted. SI units: required, unless p = 1.5 with a material, which gives it.
    """
    strength: Strength = None

    @property
    def of_spheres(self) -> bool:
        """Whether the exponent is that of spheres."""
        return self.exponent == HERTZ

    def refuse(self, setting: Setting) -> None:
        """Refuse units that do not fit."""
        super().refuse(setting)
        if setting.material is not None and self.of_spheres and self.stiffness is not None:
            raise ValueError(
                "contact.stiffness: the material determines it for contacts of exponent 1.5; leave it out, or give the "
                "beads' `mass` (kg) in place of the material"
            )
        if setting.material is not None and not self.of_spheres and self.stiffness is None:
            raise ValueError(f"contact.stiffness: is missing; the force at an overlap of 1 m, in N/m^{self.exponent:g}")

    def contact_law(self, strength: Parameter) -> Law | None:
        """Law of the contacts; Hertz's where it is that."""
        return of_power(strength, self.exponent)

    def contact_scale(self) -> tuple[float, float | None]:
        """Exponent and constant by which contacts have the strength 1."""
        return self.exponent, self.stiffness

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold of this exponent."""
        return lacking(self.exponent)
