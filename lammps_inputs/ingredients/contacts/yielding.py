"""Contacts that yield: first loading of spheres, or along a straight line (`lammps_inputs.ingredients.plastic`)."""

from collections.abc import Callable
from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import base, plastic
from lammps_inputs.ingredients.base import Setting, Solids
from lammps_inputs.ingredients.contact import HERTZ
from lammps_inputs.ingredients.contacts.power import PowerContact
from lammps_inputs.laws import Law, Parameter


@base.with_keys({"yield": (Annotated[plastic.Yield, Field(description="How contacts yield.")], ...)})
class YieldingContact(PowerContact):
    """A force that depends on the largest overlap so far, from a yield strength or an overlap at yield on."""

    example: ClassVar[str] = "{yield: {overlap: 0.1}}"
    sources_of_laws: ClassVar[dict[str, dict[str, tuple[str, ...]]]] = {"contact.yield": plastic.SOURCES}

    key: ClassVar[str] = "yield"
    noun: ClassVar[str] = "contacts that yield"

    @model_validator(mode="before")
    @classmethod
    def _of_first_loading(cls, keys: Any) -> Any:
        """The exponent of the law, where none is named."""
        yields = keys.get("yield") if isinstance(keys, dict) else None
        straight = isinstance(yields, dict) and yields.get("law") == "walton-braun"
        return {"exponent": 1.0, **keys} if straight else keys

    def refuse(self, setting: Setting) -> None:
        """Refuse another exponent than that of the law, and what is not known of contacts that yield."""
        exponent = 1.0 if self.yields.linear else HERTZ
        if self.exponent != exponent:
            raise ValueError(f"contact.exponent: {exponent:g} with the law {self.yields.law}; leave it out")
        if setting.material is not None and setting.material.yield_strength is not None:
            raise ValueError("contact.yield: material.yield_strength makes the contacts yield; leave one of them out")
        super().refuse(setting)
        self.yields.refuse(setting)

    @property
    def yields(self) -> plastic.Yield:
        """Law of contacts that yield."""
        law: plastic.Yield = vars(self)["yield"]  # the name is a keyword of Python
        return law

    def law_between(self, setting: Setting, strength: Parameter, solids: Callable[[], Solids]) -> Law:
        """Law of the contacts of solids."""
        return self.yields.law_of(setting, strength, solids)

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Facts that do not hold of contacts that yield, and of this exponent."""
        return super().lacks(setting) | plastic.WHY.keys()

    def reason(self, key: str, fact: Fact) -> str:
        """Key and reason for a fact that it removes: by the exponent of straight lines, or because contacts yield."""
        by_exponent = self.yields.linear and fact in self.why
        return super().reason(key, fact) if by_exponent else f"{key}.yield: {plastic.WHY[fact]}"

    def cited(self) -> tuple[str, ...]:
        """Publications of the law, and of strengths that differ."""
        return (*super().cited(), *plastic.SOURCES[self.yields.law])
