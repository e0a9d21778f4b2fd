"""Contacts under a static load, in incremental form: rest is exactly rest, and its energy exactly 0.

The strain counts from the static state, in which the overlap is ``rest`` and the force ``load``. Whatever holds the
beads there (forces on the ends, walls, gravity) is constant, and so part of the law: what a link adds to it is all that
moves the beads. Nesterenko, Dynamics of Heterogeneous Materials (2001), chapter 1.
"""

from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from lammps_inputs.deck_lines import BeadLayout, DeckLines
from lammps_inputs.laws import Law, Parameter, Pure
from lammps_inputs.laws.contact import LEAST_OVERLAP, Hertz, Power, wall_of_power
from lammps_inputs.laws.plastic import Thornton
from lammps_inputs.units import Dimension

_NEWTON = 60

_NEAR, _TERMS = 0.1, 14
"""Strain over the overlap at rest up to which an energy is its series, to the last digit with so many terms."""


class Preloaded(Law):
    """``A (d0 + s)+^1.5 - F0`` with ``F0 = A d0^1.5``."""

    strength: Pure
    """A, in units of the scale's contact constant."""
    rest: Annotated[Parameter, Dimension("length")]
    """d0, the overlap at rest."""
    load: Annotated[Parameter, Dimension("force")]
    """F0, to the last bit what the first term is at s = 0."""
    exponent = 1.5
    wall = wall_of_power

    @staticmethod
    def force(s: Any, strength: Any, rest: Any, load: Any) -> Any:
        """Repulsion above that at rest; below it where the beads are farther apart."""
        closed = np.maximum(rest + s, 0.0)
        return strength * (closed * np.sqrt(closed)) - load

    @staticmethod
    def energy(s: Any, strength: Any, rest: Any, load: Any) -> Any:
        """``U(d0 + s) - U(d0) - F0 s`` with ``U = 2/5 A d^2.5``, written without a difference of like numbers."""
        closed = np.maximum(rest + s, 0.0)
        root, base = np.sqrt(closed), np.sqrt(rest)
        both = root + base
        e = np.maximum(s, -rest) / np.where(both > 0.0, both, 1.0)  # root - base
        bent = strength * (e * e * (base * (base * (3.0 * base + 4.0 * e) + 2.0 * e * e) + 0.4 * e * e * e))
        return bent + load * np.maximum(-(rest + s), 0.0)

    @staticmethod
    def stiffness(s: Any, strength: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """``3/2 A (d0 + s)+^0.5``."""
        return strength * (1.5 * np.sqrt(np.maximum(rest + s, 0.0)))

    @staticmethod
    def max_strain(energy: Any, strength: Any, rest: Any, load: Any) -> Any:
        """Strain at which one contact holds all of the energy; 0 where there is no contact."""
        present = np.asarray(strength) > 0.0
        a = np.where(present, strength, 1.0)
        strain = _strain(energy, Preloaded(a, rest, load), (2.5 * energy / a) ** 0.4)
        return np.where(present, strain, 0.0)

    def along(self, name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS commands of the contact itself; `lammps_inputs.static_load` subtracts the load."""
        return Hertz(self.strength).along(name, layout)


class PreloadedPower(Law):
    """``A (d0 + s)+^p - F0`` with ``F0 = A d0^p``, p >= 1, written as ``F0 ((1 + s / d0)^p - 1)``: 0 at s = 0."""

    strength: Pure
    """A, in units of the scale's contact constant."""
    exponent: Pure
    """p."""
    rest: Annotated[Parameter, Dimension("length")]
    """d0, the overlap at rest, never quite 0."""
    load: Annotated[Parameter, Dimension("force")]
    """F0."""
    wall = wall_of_power

    @staticmethod
    def force(s: Any, strength: Any, exponent: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """Repulsion above that at rest; below it where the beads are farther apart."""
        closer = s / np.maximum(rest, _LEAST)
        return load * np.expm1(exponent * np.log1p(np.maximum(closer, _OPEN)))

    @staticmethod
    def energy(s: Any, strength: Any, exponent: Any, rest: Any, load: Any) -> Any:
        """``U(d0 + s) - U(d0) - F0 s`` with ``U = A d^(p + 1) / (p + 1)``; of small strains from their series."""
        power = exponent + 1.0
        held = strength * np.maximum(rest + s, 0.0) ** power - strength * rest**power
        closer = np.clip(s / np.maximum(rest, _LEAST), -_NEAR, _NEAR)
        term = 0.5 * exponent * load * rest * closer * closer
        series = 0.0 * term
        for k in range(_TERMS):
            series = series + term
            term = term * (closer * (exponent - 1.0 - k) / (k + 3.0))
        return np.where(np.abs(s) < _NEAR * rest, series, held / power - load * s)

    @staticmethod
    def stiffness(s: Any, strength: Any, exponent: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """``p A (d0 + s)+^(p - 1)``."""
        overlap = rest + s
        return strength * (exponent * np.maximum(overlap, LEAST_OVERLAP) ** (exponent - 1.0)) * (overlap > 0.0)

    @staticmethod
    def max_strain(energy: Any, strength: Any, exponent: Any, rest: Any, load: Any) -> Any:
        """Strain at which one contact holds all of the energy."""
        alone = Power.max_strain(energy, strength, exponent)
        return _strain(energy, PreloadedPower(strength, exponent, rest, load), alone)

    def along(self, name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS commands of the contact itself; `lammps_inputs.static_load` subtracts the load."""
        return Power(self.strength, self.exponent).along(name, layout)


_OPEN = -1.0 + 2.0**-53
"""Strain over the overlap at rest of a contact that is open."""

_LEAST = 1e-80
"""In place of an overlap of 0; its third power is a number, and so is that of any overlap over it."""


Contact = Hertz | Power | Thornton
"""Laws of contacts that have a form under a static load."""


def rest_under(law: Contact, load: Parameter) -> Parameter:
    """Overlap at which a contact has a force; 0 where there is no contact."""
    present = np.asarray(law.strength) > 0.0
    bare = np.where(present, np.asarray(load) / np.where(present, law.strength, 1.0), 0.0)
    if isinstance(law, Thornton):
        beyond = (bare / np.sqrt(law.onset) + 0.5 * law.onset) / 1.5
        return _plain(np.where(bare > law.onset**1.5, beyond, np.cbrt(bare) ** 2))
    return _plain(bare ** (1.0 / law.exponent) if isinstance(law, Power) else np.cbrt(bare) ** 2)


def under(law: Contact, load: Parameter, grid: float) -> Preloaded | PreloadedPower | Thornton:
    """The contact that carries a load at rest, as nearly as places that are multiples of ``grid`` allow.

    Args:
        law: law of the contact without load.
        load: force at rest, a number or an array of the law's shape; 0 where there is none.
        grid: distance that LAMMPS can distinguish; overlaps at rest are multiples of it, and loads follow from them.
    """
    rest = _plain(np.round(rest_under(law, load) / grid) * grid)
    if isinstance(law, Thornton):
        return law.at_rest(rest)
    if isinstance(law, Power):
        return PreloadedPower(law.strength, law.exponent, *_power_at(law, rest))
    return Preloaded(law.strength, rest, _plain(law.strength * (rest * np.sqrt(rest))))  # as the law computes it


def pressed(law: Any, factor: float) -> Any:
    """Law of a contact or wall under its static load times a factor."""
    rest, load = _power_at(law, law.rest * factor ** (1.0 / law.exponent))
    return replace(law, rest=rest, load=load)


def _power_at(law: Any, rest: Parameter) -> tuple[Parameter, Parameter]:
    """Overlap at rest, never quite 0, and the force there."""
    rest = np.maximum(rest, _LEAST) if np.ndim(rest) else max(float(rest), _LEAST)
    return rest, law.strength * rest**law.exponent


def _plain(value: Any) -> Parameter:
    """An array, or a number of Python's."""
    return np.asarray(value) if np.ndim(value) else float(value)


def _strain(energy: Any, law: Preloaded | PreloadedPower, alone: Any) -> Any:
    """Strain at which a contact holds an energy, by Newton's method from above, where the energy is convex.

    Args:
        energy: energy of one contact.
        law: law of the contacts.
        alone: strain at which the contact would hold the energy without load.
    """
    stiff = law.stiffness(0.0, *law)
    linear = np.sqrt(2.0 * energy / np.where(stiff > 0.0, stiff, np.inf)) + np.where(stiff > 0.0, 0.0, alone)
    s = np.minimum(alone, linear)
    for _ in range(_NEWTON):
        slope = law.force(s, *law)
        more = law.energy(s, *law) - energy
        s = s - np.where(slope > 0.0, np.maximum(more, 0.0) / np.where(slope > 0.0, slope, 1.0), 0.0)
    return s
