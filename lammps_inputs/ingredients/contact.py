"""Contacts between neighbouring beads of a chain: what every scene has, with or without a gap.

They are those of elastic spheres (Hertz 1882), unless the scene names another exponent. Measured for shells, hollow
spheres, cylinders and rubber O-rings: p from 1 to 3 (Nesterenko 2001; Spadoni & Daraio, PNAS 107, 2010).

Their strength may differ along the chains, such as of cylinders at angles; contact i lies between beads i and i + 1. A
slow ramp leaves the velocity of a pulse as it is, and changes its force and speed as strength**0.4 (Chaunsali, Kim &
Yang, Phil. Trans. R. Soc. A 376, 20170136, 2018).
"""

import math
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from lammps_inputs import strict_yaml
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import base, plastic
from lammps_inputs.ingredients.base import Phase, Positive, Rows, ScenePart, Seed, Setting, Solids, Spread
from lammps_inputs.ingredients.by_formula import MOST_EXPONENT, ByFormula, formulas
from lammps_inputs.ingredients.unequal import sizes_and_moduli
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.laws.contact import Hertz, Power
from lammps_inputs.numbers import random_shares
from lammps_inputs.system import System
from lammps_inputs.units import PURE, Label, Unit

Floats = NDArray[np.float64]
Factor = Annotated[Positive, PURE]

HERTZ = 1.5
"""Exponent of the contact of spheres."""

LEAST_OF_PULSES = 1.05
"""Exponent below which a solitary wave, if there is one, is longer than forty beads."""


@base.with_keys(
    base.ends(
        Factor | None,
        "Strength up to the first contact of the ramp.",
        "Strength from the last contact of the ramp on.",
        None,
    )
)
class Profile(ScenePart):
    """A ramp, a cosine and random factors, each absent unless given; the strength is their product."""

    example: ClassVar[str] = "{from: 1, to: 4, contacts: [50, 150]}"

    contacts: Rows | None = None
    """First and last contact of the ramp; the strength is constant before and after."""
    mean: Factor | None = None
    """Mean of the cosine; 1 if omitted."""
    amplitude: Annotated[float, Field(gt=-1e30, lt=1e30), PURE] | None = None
    """Amplitude of the cosine, smaller than its mean."""
    wavenumber: Annotated[float, Field(ge=-1e6, le=1e6), PURE] | None = None
    """Wavenumber q of the cosine, in cycles per contact."""
    phase: Phase | None = None
    """Phase of the cosine; 0 if omitted."""
    spread: Spread | None = None
    """Largest relative deviation of the random factors."""
    seed: Seed | None = None
    """Seed of the random factors, which are the same on any machine; 1 if omitted."""

    def refuse(self, key: str, contacts: int) -> None:
        """Refuse keys that miss others, and strengths that are not positive.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if not self.model_fields_set:
            raise ValueError(f"{key}: names nothing; valid: `strength: {self.example}`")
        parts = {("from", "to", "contacts"): (), ("amplitude", "wavenumber"): ("mean", "phase"), ("spread",): ("seed",)}
        for needed, more in parts.items():
            named = [name for name in (*needed, *more) if getattr(self, name) is not None]
            missing = [name for name in needed if getattr(self, name) is None]
            if named and missing:
                raise ValueError(f"{key}.{missing[0]}: is missing beside {named[0]}")
        base.refuse_range(f"{key}.contacts", self.contacts, contacts, of="contact", least=1)
        mean = 1.0 if self.mean is None else self.mean
        if self.amplitude is not None and not abs(self.amplitude) < mean:
            raise ValueError(f"{key}.amplitude: {self.amplitude:g} given; smaller than the mean, {mean:g}")

    def of(self, chains: int, contacts: int) -> Floats:
        """Strengths, [chain, contact]; random factors are those of ``numpy.random.default_rng(seed).uniform``."""
        number, strengths = np.arange(1, contacts + 1), np.ones((chains, contacts))
        if self.contacts is not None:
            strengths *= np.interp(number, self.contacts, [getattr(self, end) for end in ("from", "to")])
        if self.amplitude is not None:
            assert self.wavenumber is not None
            angle = 2.0 * math.pi * self.wavenumber * number + math.radians(self.phase or 0.0)
            strengths *= (1.0 if self.mean is None else self.mean) + self.amplitude * np.cos(angle)
        if self.spread:
            least, largest = 1.0 - self.spread, 1.0 + self.spread
            shares = random_shares(1 if self.seed is None else self.seed, chains * contacts)
            strengths *= (least + (largest - least) * shares).reshape(chains, contacts)
        return strengths


def _kind_of_values(value: Any) -> str:
    """Tag of what is given: keys, a row for all chains, rows of chains, or a number."""
    if isinstance(value, dict | Profile):
        return "<keys>"
    rows = isinstance(value, tuple | list) and any(isinstance(row, tuple | list) for row in value)
    return "<rows>" if rows else "<row>" if isinstance(value, tuple | list) else "<plain>"


_Row = tuple[Factor, ...]
Strength = Annotated[
    Annotated[Factor, Tag("<plain>")]
    | Annotated[Profile, Tag("<keys>")]
    | Annotated[_Row, Tag("<row>")]
    | Annotated[tuple[_Row, ...], Tag("<rows>")],
    Discriminator(_kind_of_values),
]
"""A number for all contacts, a profile, a list with one for each contact, or a list of such lists, one a chain."""


_Power = Annotated[float, Field(ge=1, le=MOST_EXPONENT), PURE]
Exponent = Annotated[
    Annotated[_Power, Tag("<plain>")]
    | Annotated[tuple[_Power, ...], Tag("<row>")]
    | Annotated[tuple[tuple[_Power, ...], ...], Tag("<rows>")],
    Discriminator(lambda value: "<plain>" if isinstance(value, dict) else _kind_of_values(value)),
]
"""A number for all contacts, a list with one for each, or a list of such lists, one a chain."""


def _refuse_values(key: str, strength: Any, setting: Setting) -> None:
    """Refuse a strength that does not fit the chains.

    Raises:
        ValueError: naming the key, what was found and what to do.
    """
    contacts = setting.beads - 1
    if isinstance(strength, Profile):
        strength.refuse(key, contacts)
    if not isinstance(strength, tuple):
        return
    rows = strength if isinstance(strength[0] if strength else None, tuple) else (strength,)
    if len(rows) != 1:
        base.refuse_other_count(key, rows, setting.chains, noun="lists")
    for row in rows:
        if len(row) != contacts:
            raise ValueError(f"{key}: {len(row)} numbers for the {contacts} contacts of {setting.beads} beads")


@base.with_keys(
    {
        "yield": (
            Annotated[plastic.Yield | None, Field(description="How contacts yield; they are elastic if omitted.")],
            None,
        )
    }
)
class Contact(ByFormula):
    """A force ``stiffness * overlap**exponent``, or any that grows as beads come closer."""

    example: ClassVar[str] = "{exponent: 2}"

    why: ClassVar[dict[Fact, str]] = {
        Fact.REVERSIBLE: "contacts of an exponent below 1.5 open and close so abruptly that suzuki4 gains nothing",
    }
    sources_of_laws: ClassVar[dict[str, dict[str, tuple[str, ...]]]] = {"contact.yield": plastic.SOURCES}

    exponent: Annotated[Exponent, Label("contact exponent", "p")] = HERTZ
    """Exponent p, or a list with one for each contact; in reduced units and without `stiffness`."""
    stiffness: Annotated[Annotated[Positive, Unit("N/m^p")] | None, Label("contact constant", "A")] = None
    """Constant A. Reduced units: 1 if omitted. With a material: required unless p = 1.5, where the material gives it.
    """
    strength: Annotated[Strength | None, Label("contact strength")] = None
    """Factor on A of each contact: a number, a profile, or a list with one for each contact; 1 if omitted."""

    force: str | None = None
    """Force as a formula of s, with its parameters as keys beside it, in place of `exponent` and `stiffness`; what s is
    stands in the scene reference, *Force by formula*.
    """
    tension: Literal["allowed", "cut"] | None = None
    """Whether `force` acts at a distance: if omitted, `cut` of forces that are 0 at s = 0, and `allowed` of others."""

    _from_list = field_validator("strength", "exponent", mode="before")(strict_yaml.as_tuple)

    @model_validator(mode="before")
    @classmethod
    def _straight(cls, keys: Any) -> Any:
        """The exponent of contacts that yield along straight lines, where none is named."""
        yields = keys.get("yield") if isinstance(keys, dict) else None
        straight = isinstance(yields, dict) and yields.get("law") == "walton-braun" and "force" not in keys
        return {"exponent": 1.0, **keys} if straight else keys

    @field_validator("exponent")
    @classmethod
    def _one_for_each(cls, value: Any) -> Any:
        rows = value if isinstance(value, tuple) and value and isinstance(value[0], tuple) else (value,)
        if any(row == () for row in rows) or len({np.size(row) for row in rows}) > 1:
            raise ValueError("should have one number for each contact of each chain")
        return value

    def refuse(self, setting: Setting) -> None:
        """Refuse units that do not fit, what is known of spheres only, and profiles that do not fit the chains."""
        if not self.model_fields_set:
            raise ValueError(f"contact: names nothing; valid: `contact: {self.example}`")
        if self.formula is not None:
            self._refuse_formula(self.formula, setting)
            return
        if self.tension is not None:
            raise ValueError("contact.tension: is that of a formula; give contact.force, too, or leave it out")
        _refuse_values("contact.exponent", self.exponent, setting)
        if self._powers is not None:
            self._refuse_exponents(setting)
        if self.yields is not None and "exponent" in self.model_fields_set and self.exponent != self._power:
            raise ValueError(f"contact.exponent: {self._power:g} with the law {self.yields.law}; leave it out")
        if setting.material is not None and self._power == HERTZ and self.stiffness is not None:
            raise ValueError("contact.stiffness: the material determines it for contacts of exponent 1.5; leave it out")
        if setting.material is not None and self._power != HERTZ and self.stiffness is None:
            raise ValueError(f"contact.stiffness: is missing; the force at an overlap of 1 m, in N/m^{self._power:g}")
        if self.yields is not None:
            self.yields.refuse(setting)

    @property
    def yields(self) -> plastic.Yield | None:
        """Law of contacts that yield; None where they are elastic."""
        law: plastic.Yield | None = vars(self)["yield"]  # the name is a keyword of Python
        return law

    @property
    def _powers(self) -> Floats | None:
        """Exponents of the contacts, [1 or chain, contact]; None where all are the same."""
        return None if np.ptp(self.exponent) == 0.0 else np.atleast_2d(self.exponent)

    @property
    def _power(self) -> float:
        """Exponent of first loading; where contacts have their own, that by which lengths are measured."""
        if self.yields is None:
            return HERTZ if self._powers is not None else float(np.max(self.exponent))
        return 1.0 if self.yields.linear else HERTZ

    def _refuse_exponents(self, setting: Setting) -> None:
        """Refuse what is said for contacts of one exponent only."""
        keys = ("material", "walls", "gravity", "precompression", "window", "taper")
        others = [key for key in keys if setting.part(key)]
        others += ["contact.stiffness"] * (self.stiffness is not None)
        damping = setting.part("damping")
        if damping is not None and damping.contact:
            others += ["damping.law"] * (damping.law not in (None, "linear"))
            others += ["damping.tension"] * (damping.tension == "cut")
        if others:
            raise ValueError(
                f"{others[0]}: is known for contacts of one exponent, and contact.exponent is a list; leave one of "
                "them out"
            )

    def _refuse_formula(self, force: Any, setting: Setting) -> None:
        """Refuse what is said twice, and forces at rest that nothing holds."""
        self.refuse_beside("contact", "exponent", "stiffness", "yield")
        kind = formulas().kind_of_contact(force, self.tension)
        rest = force.at_rest
        if kind.cut and rest:
            raise ValueError(f"contact.tension: the force is {rest:.6g} at s = 0, where it would be cut; leave it out")
        damping = setting.part("damping")
        if not kind.cut and damping is not None and damping.contact:
            raise ValueError(
                "damping.contact: is that of contacts that touch, and contact.force acts at a distance; take "
                "damping.beads, or leave it out"
            )
        if rest:
            walls = setting.part("walls")
            if walls is None or None in (walls.left, walls.right):
                raise ValueError(
                    f"contact.force: pushes neighbours apart with {rest:.6g} at rest, and nothing holds the beads at "
                    "the ends; give `walls: {left: bead, right: bead}`"
                )
            loads = [key for key in ("gap", "precompression", "gravity") if setting.part(key)]
            loads += ["contact.strength"] * (self.strength is not None)
            if loads:
                raise ValueError(
                    f"{loads[0]}: contact.force is {rest:.6g} at s = 0, the force of every contact at rest; leave one "
                    "of them out"
                )
        elif not kind.cut and setting.gap:
            raise ValueError(
                "gap: contact.force acts at a distance, so that beads a gap apart pull each other at rest; leave "
                "the gap or contact.tension out"
            )

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse what is known of spheres only, and formulas where they have no value."""
        for link in system.along if self.formula is not None else ():
            if link.law.source is not None:
                formulas().refuse_reach("contact", link.law, system, setting.scale.length, pressed=True)
        if not any(np.any(np.not_equal(ratios, 1.0)) for ratios in sizes_and_moduli(setting)):
            return
        if self.formula is not None:
            raise ValueError(
                "contact.force: how the contacts of beads of unlike radius or modulus differ is known for spheres; let "
                "them differ in mass alone"
            )
        other = f"{self._power:g}" if self._powers is None else "a list"
        if other != f"{HERTZ:g}":
            raise ValueError(
                f"contact.exponent: {other} given; how the contacts of beads of unlike radius or modulus "
                "differ is known for spheres, which have 1.5; let them differ in mass alone"
            )

    def contact_law(self, strength: Parameter) -> Law:
        """Law of the contacts; Hertz's where it is that."""
        exponent, _, is_power = self._begins
        if not is_power:
            kind = formulas().kind_of_contact(self.formula, self.tension)
            law: Law = self.formula.law(formulas().AlongChains, kind, strength)
            return law
        if self._powers is not None:
            return Power(strength * np.ones_like(self._powers), self._powers)
        return Hertz(strength) if exponent == HERTZ else Power(strength, exponent)

    def law_between(self, setting: Setting, strength: Parameter, solids: Callable[[], Solids]) -> Law | None:
        """Law of the contacts, those that yield included."""
        if self.yields is not None:
            return self.yields.law_of(setting, strength, solids)
        return super().law_between(setting, strength, solids)

    def reason(self, key: str, fact: Fact) -> str:
        """Key and reason for a fact that it removes: by the exponent, or because contacts yield."""
        by_exponent = self.yields is None or (self.yields.linear and fact in self.why)
        return super().reason(key, fact) if by_exponent else f"{key}.yield: {plastic.WHY[fact]}"

    def cited(self) -> tuple[str, ...]:
        """Publications of the profile, of a law that yields, and of exponents that differ."""
        law: tuple[str, ...] = () if self.yields is None else plastic.SOURCES[self.yields.law]
        if not self._cut:
            law = ("moleron2014",)
        if self._powers is not None:
            law = ("nesterenko2001", "spadoni2010")
        return law if self.strength is None else ("chaunsali2018", *law)

    @property
    def strength_key(self) -> str:
        """Key of the profile, of the formula, or of exponents that differ."""
        values = {"contact.strength": self.strength, "contact.force": self.force, "contact.exponent": self._powers}
        return next((key for key, value in values.items() if value is not None), "")

    def strengths(self, setting: Setting) -> Parameter:
        """Strengths of the profile, at the overlap by which lengths are measured."""
        factors: Parameter = 1.0
        if self.strength is not None:
            _refuse_values("contact.strength", self.strength, setting)
            shape = (setting.chains, setting.beads - 1)
            if isinstance(self.strength, Profile):
                factors = self.strength.of(*shape)
            elif isinstance(self.strength, tuple):
                factors = np.array(np.broadcast_to(self.strength, shape))
            else:
                factors = self.strength
        if self._powers is not None:
            factors = factors * setting.scale.length ** (self._powers - HERTZ)
        return factors

    def contact_scale(self) -> tuple[float, float | None]:
        """Exponent and constant by which contacts have the strength 1; of a formula those of small overlaps."""
        return self._begins[:2]

    @property
    def _begins(self) -> tuple[float, float | None, bool]:
        """Exponent p and constant A of the force ``A overlap^p`` of small overlaps, and whether it is that of all."""
        if self.formula is None:
            return self._power, self.stiffness, True
        kind = formulas().kind_of_contact(self.formula, self.tension)
        begins: tuple[float, float, bool] = formulas().power_of_contact(self.formula, kind)
        return begins

    @property
    def _cut(self) -> bool:
        """Whether there is no force where beads are apart."""
        return self.formula is None or bool(formulas().kind_of_contact(self.formula, self.tension).cut)

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Linear contacts disperse any pulse; all that are harder at first than spheres begin abruptly.

        What acts at a distance transmits sound.
        """
        exponent = self.contact_scale()[0] if self._powers is None else float(np.min(self._powers))
        if not self._cut:
            return frozenset({Fact.SONIC_VACUUM, Fact.FRONT, Fact.PULSE})
        taken = {Fact.REVERSIBLE} if exponent < HERTZ else set()
        taken |= set() if self.yields is None else plastic.WHY.keys()
        return frozenset(taken | {Fact.PULSE} if exponent < LEAST_OF_PULSES else taken)
