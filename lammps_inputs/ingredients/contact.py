"""Contacts between neighbouring beads of a chain: what all laws have in common that the keys of `contact` choose.

Every scene has contacts, with or without a gap; they are those of elastic spheres (Hertz 1882), unless `contact` names
others. A law is a class derived from `Contact`, which an entry point of ``granchain.contacts`` declares; it is chosen
by its `key`, has its keys beside it, and says what it excludes. The first, of one exponent, is that of no such key.

The strength of the contacts may differ along the chains, such as of cylinders at angles; contact n lies between beads n
and n + 1. A slow ramp leaves the velocity of a pulse as it is, and changes its force and speed as strength**0.4
(Chaunsali, Kim & Yang, Phil. Trans. R. Soc. A 376, 20170136, 2018).

Examples:
    >>> contact.Contact.kind_of({"yield": {"overlap": 0.1}}).__name__
    'YieldingContact'
    >>> granchain.load("one-chain", {"contact.exponent": 2.0}).contact.contact_law(0.5)  # at half the strength
    Power(strength=0.5, exponent=2.0)
"""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, ValidationError, field_validator, model_validator

from lammps_inputs import plugins, strict_yaml
from lammps_inputs.errors import InputError
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import profile
from lammps_inputs.ingredients.base import Ingredient, Setting
from lammps_inputs.ingredients.unequal import sizes_and_moduli
from lammps_inputs.laws import Parameter
from lammps_inputs.laws.contact import Hertz, Power
from lammps_inputs.system import System
from lammps_inputs.units import Label

HERTZ = 1.5
"""Exponent of the contact of spheres."""

MOST_EXPONENT = 3.0
"""Exponent up to which there are solitary waves to compare with."""

LEAST_OF_PULSES = 1.05
"""Exponent below which a solitary wave, if there is one, is longer than forty beads."""

Strength = Annotated[
    profile.Values[profile.Factor] | None,
    Label("contact strength"),
    Field(
        description="Factor on A of each contact: a number, a profile, or a list with one for each contact; 1 if "
        "omitted."
    ),
]


class Contact(Ingredient):
    """Contacts of one law; base of the classes that are laws."""

    example: ClassVar[str] = "{exponent: 2}"
    why: ClassVar[dict[Fact, str]] = {
        Fact.REVERSIBLE: "contacts of an exponent below 1.5 open and close so abruptly that suzuki4 gains nothing",
    }

    key: ClassVar[str]
    """Key that chooses the law, and names it in messages."""
    noun: ClassVar[str]
    """What the contacts are, in messages: ``contacts of one exponent``."""

    if TYPE_CHECKING:  # each law declares it, in the order of its keys

        @property
        def strength(self) -> Any:
            """Strengths as the scene gives them; None for 1."""

    _from_list = field_validator("strength", "exponent", mode="before", check_fields=False)(strict_yaml.as_tuple)

    @staticmethod
    def laws() -> "tuple[type[Contact], ...]":
        """Laws that installed distributions declare; the first is that where no key chooses another.

        Raises:
            InputError: one is no law of contacts.
        """
        for key, kind in plugins.loaded("contacts").items():
            if not (isinstance(kind, type) and issubclass(kind, Contact)):
                raise InputError(
                    f"granchain.contacts: {key} = {plugins.declared('contacts')[key].value} should be a class derived "
                    "from lammps_inputs.ingredients.contact.Contact"
                )
        return tuple(plugins.loaded("contacts").values())

    @classmethod
    def kinds(cls) -> tuple[type[Ingredient], ...]:
        """Laws among which the keys choose; of a law itself alone."""
        return cls.laws() if cls is Contact else (cls,)

    @classmethod
    def is_named(cls, keys: dict[str, Any]) -> bool:
        """Whether keys choose this law, in plain data of a scene."""
        return keys.get(cls.key) is not None

    @classmethod
    def kind_of(cls, value: Any) -> type[Ingredient]:
        """The law that plain data, or contacts, are of; the first where no key chooses another."""
        if isinstance(value, Contact):
            return type(value)
        first, *others = cls.laws()
        return next((law for law in others if isinstance(value, dict) and law.is_named(value)), first)

    @model_validator(mode="before")
    @classmethod
    def _of_one_law(cls, keys: Any) -> Any:
        """Refuse no keys, and keys of other laws.

        Raises:
            ValidationError: naming each of them.
        """
        if not isinstance(keys, dict):
            return keys
        if not keys:
            raise ValueError(f"names nothing; valid: `contact: {cls.example}`")
        others = {name for law in Contact.laws() for name in law.model_fields} - cls.model_fields.keys()
        wrong: list[Any] = [
            {
                "type": "value_error",
                "loc": (name,),
                "input": value,
                "ctx": {"error": ValueError(f"is no key of {cls.noun}; leave one of them out")},
            }
            for name, value in keys.items()
            if name in others and value is not None
        ]
        if wrong:
            raise ValidationError.from_exception_data(cls.__name__, wrong)
        return {name: value for name, value in keys.items() if name not in others}

    @property
    def of_spheres(self) -> bool:
        """Whether first loading is that of spheres, of which radii, moduli and yield strengths say how they differ."""
        return False

    def refuse(self, setting: Setting) -> None:
        """Refuse strengths that do not fit the chains."""
        self.strengths(setting)

    def refuse_system(self, setting: Setting, system: System) -> None:  # noqa: ARG002
        """Refuse what is known of spheres only."""
        if not self.of_spheres and any(np.any(np.not_equal(ratios, 1.0)) for ratios in sizes_and_moduli(setting)):
            raise ValueError(
                f"contact.{self.key}: how the contacts of beads of unlike radius or modulus differ is known for "
                "spheres, of exponent 1.5; let them differ in mass alone"
            )

    def cited(self) -> tuple[str, ...]:
        """Publications of the law, and of strengths that differ."""
        return self.sources if self.strength is None else ("chaunsali2018", *self.sources)

    @property
    def strength_key(self) -> str:
        """Key of the strengths, where these are named."""
        return "" if self.strength is None else "contact.strength"

    def strengths(self, setting: Setting) -> Parameter:
        """Strengths of the contacts, a number or [chain, contact]."""
        return 1.0 if self.strength is None else profile.values_of("contact.strength", self.strength, setting.contacts)


def of_power(strength: Parameter, exponent: float) -> Hertz | Power:
    """Law ``strength * overlap**exponent``; Hertz's where it is that."""
    return Hertz(strength) if exponent == HERTZ else Power(strength, exponent)


def lacking(exponent: float) -> frozenset[Fact]:
    """Facts that do not hold of contacts whose force begins with a power of the overlap.

    Linear contacts disperse any pulse; all that are harder at first than spheres begin abruptly.
    """
    taken = {Fact.REVERSIBLE} if exponent < HERTZ else set()
    return frozenset(taken | {Fact.PULSE} if exponent < LEAST_OF_PULSES else taken)
