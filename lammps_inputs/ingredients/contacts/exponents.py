"""Contacts of exponents that differ: a list, or a profile with random factors."""

from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import profile
from lammps_inputs.ingredients.base import Setting
from lammps_inputs.ingredients.contact import HERTZ, MOST_EXPONENT, Contact, Strength, lacking, of_power
from lammps_inputs.ingredients.contacts.power import Exponent
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.contact import Power
from lammps_inputs.units import Label

Floats = NDArray[np.float64]


class UnlikeContacts(Contact):
    """A force ``overlap**exponent`` whose exponent differs from contact to contact, in reduced units."""

    example: ClassVar[str] = "{exponent: {spread: 0.1, seed: 1}}"
    sources = ("nesterenko2001", "spadoni2010")

    key: ClassVar[str] = "exponent"
    noun: ClassVar[str] = "contacts of several exponents"

    exponent: Annotated[profile.Listed[Exponent], Label("contact exponent", "p")]
    """A list with the exponent of each contact, or a profile; in reduced units."""
    strength: Strength = None

    @classmethod
    def is_named(cls, keys: dict[str, Any]) -> bool:
        """Whether `exponent` is no number."""
        return isinstance(keys.get("exponent"), dict | list | tuple)

    @field_validator("exponent")
    @classmethod
    def _a_number_for_each(cls, value: Any) -> Any:
        rows = value if isinstance(value, tuple) and value and isinstance(value[0], tuple) else (value,)
        if any(row == () for row in rows) or len({np.size(row) for row in rows}) > 1:
            raise ValueError("should have one number for each contact of each chain")
        return value

    def refuse(self, setting: Setting) -> None:
        """Refuse what is known for contacts of one exponent only."""
        super().refuse(setting)
        keys = ("material", "walls", "gravity", "precompression", "window", "taper")
        others = [key for key in keys if setting.part(key)]
        damping = setting.part("damping")
        if damping is not None and damping.contact:
            others += ["damping.law"] * (damping.law not in (None, "linear"))
            others += ["damping.tension"] * (damping.tension == "cut")
        if others:
            raise ValueError(
                f"{others[0]}: is known for contacts of one exponent, and contact.exponent has several; leave one of "
                "them out"
            )

    def law_between(self, setting: Setting, strength: Parameter, solids: Any) -> Law:  # noqa: ARG002
        """Law of the contacts."""
        exponents = self._exponents(setting)
        if np.ptp(exponents) == 0.0:
            return of_power(strength, float(exponents.flat[0]))
        return Power(strength * np.ones_like(exponents), exponents)

    @property
    def strength_key(self) -> str:
        """Key of the strengths, or of the exponents."""
        return super().strength_key or "contact.exponent"

    def strengths(self, setting: Setting) -> Parameter:
        """Strengths of the contacts, [chain, contact], at the unit of length, which is that of spheres."""
        return super().strengths(setting) * setting.scale.length ** (self._exponents(setting) - HERTZ)

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Facts that do not hold of the least exponent."""
        return lacking(float(np.min(self._exponents(setting))))

    def _exponents(self, setting: Setting) -> Floats:
        """Exponents, [chain, contact].

        Raises:
            ValueError: they do not fit the chains, or are out of range.
        """
        exponents = np.asarray(profile.values_of("contact.exponent", self.exponent, setting.contacts, HERTZ))
        least, largest = float(np.min(exponents)), float(np.max(exponents))
        if not (least >= 1.0 and largest <= MOST_EXPONENT):
            raise ValueError(f"contact.exponent: goes from {least:.6g} to {largest:.6g}; from 1 to {MOST_EXPONENT:g}")
        return exponents
