"""Ingredients whose force may be a formula of the scene's: ``force``, with its parameters as keys beside it."""

import functools
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)

from lammps_inputs import laws, physics
from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.laws import expression, formula_law
from lammps_inputs.laws.expression import STRAIN
from lammps_inputs.laws.formula_law import Force
from lammps_inputs.system import System

_SPAN = np.geomspace(1e-9, 1e9, 109)
"""Strains at which formulas are compared, in any units."""

_SAME, _ROUNDED = 1e-12, 1e-13

MOST_EXPONENT = 3.0
"""Exponent of contacts up to which there are solitary waves to compare with."""

STIFFEST = 1e12
"""Dimensionless stiffness; beyond it the beads do not move."""

SMALL = 1e-20
"""A strain at which only the leading power of a force is left, in any units."""


def _complaint(model: type[BaseModel], force: str, why: str) -> ValidationError:
    error: Any = {"type": "value_error", "loc": ("force",), "input": force, "ctx": {"error": ValueError(why)}}
    return ValidationError.from_exception_data(model.__name__, [error])


def _other_keys_with_force(schema: dict[str, Any]) -> None:
    """Keys that are not known are those of a formula's parameters."""
    schema["anyOf"] = [{"required": ["force"]}, {"propertyNames": {"enum": list(schema["properties"])}}]


class ByFormula(Ingredient):
    """Keys that are known, and with ``force`` one for each parameter that it names."""

    model_config = ConfigDict(extra="allow", json_schema_extra=_other_keys_with_force)
    __pydantic_extra__: dict[str, Annotated[float, Field(ge=-1e30, le=1e30)]]

    if TYPE_CHECKING:  # each subclass declares it, in the order of its keys
        force: str | None

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, keys: Any) -> Any:
        """Refuse other keys, and missing parameters.

        Raises:
            ValidationError: naming each of them.
        """
        if not isinstance(keys, dict):
            return keys
        fields = {field.alias or name for name, field in cls.model_fields.items()}
        named = cls.parameters_of(keys.get("force"))
        if named is None and isinstance(keys["force"], str):
            raise _complaint(cls, keys["force"], cls._wrong(keys["force"]))
        if named is None:  # no text
            return {key: value for key, value in keys.items() if key in fields}
        wrong: list[Any] = [
            {"type": "extra_forbidden", "loc": (key,), "input": value}
            for key, value in keys.items()
            if key not in fields and key not in named
        ]
        wrong += [
            {"type": "missing", "loc": (name,), "input": keys}
            for name in named
            if name not in keys and name not in fields
        ]
        if wrong:
            raise ValidationError.from_exception_data(cls.__name__, wrong)
        return keys

    @classmethod
    def parameters_of(cls, force: Any) -> tuple[str, ...] | None:
        """Parameters of a formula; None of what is none."""
        if force is None:
            return ()
        if not isinstance(force, str) or cls._wrong(force):
            return None
        return tuple(name for name in expression.names(force) if name != STRAIN)

    @classmethod
    def _wrong(cls, force: str) -> str:
        """Reason why a text is no formula of s; empty if it is one."""
        try:
            named = expression.names(force)
        except expression.FormulaError as error:
            return str(error)
        if STRAIN not in named:
            return "holds no `s`, of which it should be a formula, such as k*s"
        meant = next((name for name in named if name in cls.model_fields), None)
        return "" if meant is None else f"names `{meant}`, a key with another meaning; take another name, such as k"

    @model_serializer(mode="wrap")
    def _without_defaults(self, usual: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Keys of the part; with a formula only those that differ from their defaults."""
        written: dict[str, Any] = usual(self)
        if self.force is None:
            return written
        fields = type(self).model_fields
        return {key: value for key, value in written.items() if key not in fields or value != fields[key].default}

    @property
    def formula(self) -> Force | None:
        """The force and its parameters, in the scene's units; None where it is no formula."""
        if self.force is None:
            return None
        return Force(self.force, tuple(sorted((self.__pydantic_extra__ or {}).items())))

    def refuse_beside(self, part: str, *keys: str) -> None:
        """Refuse keys that say what the formula says.

        Raises:
            ValueError: naming the first.
        """
        for key in keys if self.formula is not None else ():
            if getattr(self, key) != type(self).model_fields[key].default:
                raise ValueError(f"{part}.{key}: {part}.force is the whole force; leave one of them out")


# --- what a formula is ------------------------------------------------------------------------------------------------
# computed once for each force, for a scene needs it wherever it needs a unit or a law


@functools.lru_cache(maxsize=256)
def multiple_of_strain(force: Force) -> float | None:
    """K of a force that is ``k s``; None of others."""
    k = float(force.at(1.0))
    s = np.concatenate([-_SPAN, _SPAN])
    return k if np.isfinite(k) and np.allclose(force.at(s), k * s, rtol=_ROUNDED, atol=0.0) else None


@functools.lru_cache(maxsize=256)
def kind_of_contact(force: Force, tension: str | None) -> formula_law.FormulaKind:
    """How the formula counts s, and whether it is cut where beads are apart.

    Raises:
        ValueError: there is no contact of such a force.
    """
    rest, small = force.at_rest, SMALL
    if not np.isfinite(rest):
        raise ValueError("contact.force: has no real value at s = 0, where beads rest; valid: `A/(d+s)^p` with d > 0")
    if rest < 0.0:
        raise ValueError(f"contact.force: is {rest:.6g} at s = 0, so that beads pull each other at rest; at least 0")
    law = force.law(formula_law.AlongChains)
    slopes = [float(law.stiffness(s, *law)) for s in (small, -small)]
    direction = 1.0 if slopes[0] > 0.0 or slopes[1] > 0.0 else -1.0
    if not any(abs(slope) > 0.0 for slope in slopes):
        raise ValueError("contact.force: is the same at all s near 0; it should grow as beads come closer")
    if not np.isfinite(slopes[0 if direction > 0.0 else 1]):
        raise ValueError("contact.force: falls as beads come closer; it should grow, as A*s^1.5 with A > 0")
    kind = formula_law.FormulaKind(direction, cut=rest == 0.0 if tension is None else tension == "cut")
    if not kind.cut and not np.isfinite(slopes[1 if direction > 0.0 else 0]):
        if tension is None:
            raise ValueError(
                f"contact.force: is {rest:.6g} at s = 0, so that it acts at a distance, and has no real value where "
                "beads are apart; a force of beads that touch is 0 at s = 0, as A*s^1.5"
            )
        raise ValueError(
            "contact.tension: the force has no real value where beads are apart; leave it out: it is then cut there"
        )
    return kind


@functools.lru_cache(maxsize=256)
def power_of_contact(force: Force, kind: formula_law.FormulaKind) -> tuple[float, float, bool]:
    """Exponent and constant of ``A s^p``, as which a contact's force begins above that at rest; whether it is that.

    Raises:
        ValueError: p is below 1.
    """
    law = force.law(formula_law.AlongChains, kind)
    stiffness = [float(law.stiffness(s, *law)) for s in (SMALL, 2.0 * SMALL)]
    if not 0.999 * stiffness[0] <= stiffness[1] < np.inf:
        raise ValueError("contact.force: is infinitely stiff at s = 0; powers of s from 1 on are valid")
    exponent = 1.0 + round(float(np.log2(stiffness[1] / stiffness[0])), 6)
    if kind.cut and exponent <= MOST_EXPONENT:
        a = float(force.at(kind.direction))
        if np.allclose(force.at(kind.direction * _SPAN), a * _SPAN**exponent, rtol=_SAME, atol=0.0):
            return exponent, a, True
    return exponent, stiffness[0] / (exponent * SMALL ** (exponent - 1.0)), False


def refuse_unrest(key: str, force: Force) -> None:
    """Refuse springs that do not leave beads at rest where they are.

    Raises:
        ValueError: naming the key and what was found.
    """
    rest = force.at_rest
    if not np.isfinite(rest):
        raise ValueError(f"{key}.force: has no real value at s = 0, where beads rest; add a term to what is divided by")
    if rest:
        raise ValueError(f"{key}.force: is {rest:.6g} at s = 0, where beads rest; it should be 0 there")
    law = force.law(formula_law.ToGround)
    slope, beyond = (float(law.stiffness(s, *law)) for s in (SMALL, 4.0 * SMALL))
    if not np.isfinite(slope) or abs(beyond) < 0.999 * abs(slope):
        raise ValueError(f"{key}.force: is infinitely stiff at s = 0; powers of s from 1 on are valid")
    if slope < 0.0:
        raise ValueError(f"{key}.force: its slope is {slope:.6g} at s = 0, which drives beads away from rest; above 0")


def refuse_even(key: str, force: Force) -> None:
    """Refuse what is not odd: it would depend on which of two chains is counted first.

    Raises:
        ValueError: naming the key and where that shows.
    """
    positive, negative = force.at(_SPAN), force.at(-_SPAN)
    with np.errstate(all="ignore"):
        same = np.abs(positive + negative) <= 1e-9 * np.abs(positive) + _SAME * np.nanmin(np.abs(positive))
    wrong = np.flatnonzero(~same & (np.isfinite(positive) | np.isfinite(negative)))
    if len(wrong):
        s = float(_SPAN[wrong[len(wrong) // 2]])
        raise ValueError(
            f"{key}.force: is {float(force.at(s)):.6g} at s = {s:.3g} and {float(force.at(-s)):.6g} at s = {-s:.3g}; "
            "each of two beads pulls the other, so it should be odd, such as k*s + c*s^3"
        )


def refuse_reach(key: str, law: Any, system: System, length: float, *, pressed: bool = False) -> None:
    """Refuse formulas that are no number, or no spring, at strains that the energy of the system reaches.

    Args:
        key: key of the ingredient.
        law: dimensionless law.
        system: system whose energy bounds the strains.
        length: dimensionless unit of length, in the scene's units.
        pressed: whether the law keeps beads apart.

    Raises:
        ValueError: naming the key and the strain.
    """
    energy = physics.energy(system)
    law = law._replace(strength=float(np.max(law.strength)))
    for side in (1.0, -1.0):
        far = formula_law.reach(law, energy, side)
        if far == np.inf:
            if pressed and side > 0.0:
                held = float(np.max(law.energy(formula_law.FARTHEST, *law)))
                raise ValueError(
                    f"{key}.force: holds at most {held / energy:.3g} of the energy of the excitation, so beads would "
                    "pass through each other; slower kicks, or a force that grows further"
                )
            continue
        beyond = side * far * (1.0 + 1e-6)
        if float(law.energy(side * far, *law)) >= 0.99 * energy:
            continue
        s = law.kind.direction * side * far * length
        if not np.isfinite(law.force(beyond, *law)):
            raise ValueError(
                f"{key}.force: has no real value from s = {s:.3g} on, which the energy of the excitation reaches; "
                "slower kicks or other parameters"
            )
        if formula_law.first_pole(law, side, np.linspace(0.0, 1.001 * far, formula_law.FINE))[1] < np.inf:
            raise ValueError(
                f"{key}.force: is infinite at s = {s:.3g}, which the energy of the excitation reaches; slower kicks or "
                "other parameters"
            )
        raise ValueError(
            f"{key}.force: its energy falls below that at rest near s = {s:.3g}, so s = 0 is no stable rest"
        )
    stiffest = laws.stiffest(law, energy)
    if not stiffest <= STIFFEST:
        raise ValueError(
            f"{key}.force: its slope reaches {stiffest:.3g} in dimensionless units within the energy of the "
            f"excitation; at most {STIFFEST:g}, where beads do not move"
        )
