"""What ingredients ask of a formula: its parameters, its laws, how it begins at rest, and what it cannot be.

Results are computed once for each force, for a scene needs it wherever it needs a unit or a law.
"""

import functools
from dataclasses import replace
from typing import Any

import numpy as np

from lammps_inputs import laws, physics
from lammps_inputs.formulas import expression, formula_law
from lammps_inputs.formulas.expression import STRAIN
from lammps_inputs.formulas.formula_law import AcrossChains, AlongChains, Force, ToGround
from lammps_inputs.ingredients.by_formula import STIFFEST
from lammps_inputs.ingredients.contact import MOST_EXPONENT
from lammps_inputs.system import System

__all__ = [
    "AcrossChains",
    "AlongChains",
    "Force",
    "ToGround",
    "kind_of_contact",
    "multiple_of_strain",
    "parameters",
    "power_of_contact",
    "refuse_even",
    "refuse_reach",
    "refuse_unrest",
]

_SPAN = np.geomspace(1e-9, 1e9, 109)
"""Strains at which formulas are compared, in any units."""

_SAME, _ROUNDED = 1e-12, 1e-13

SMALL = 1e-20
"""A strain at which only the leading power of a force is left, in any units."""


def parameters(text: str) -> tuple[str, ...]:
    """Names of the parameters of a formula, in their order.

    Raises:
        ValueError: it is no formula of the strain; says why.
    """
    named = expression.names(text)
    if STRAIN not in named:
        raise expression.FormulaError("holds no `s`, of which it should be a formula, such as k*s")
    return tuple(name for name in named if name != STRAIN)


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
    law = replace(law, strength=float(np.max(law.strength)))
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
