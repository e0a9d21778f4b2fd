"""Contacts of two beads, or of a bead and a wall, which only ever push: a force ``strength * overlap**exponent``.

`Hertz` is that of elastic spheres (Hertz 1882), whose exponent is 1.5. `Power` has any: chains of any exponent above
1 are sonic vacua (Nesterenko, Dynamics of Heterogeneous Materials, Springer 2001, 1.2).

Under a static load contacts are in incremental form (`Preloaded`, `PreloadedPower`): rest is exactly rest, and its
energy exactly 0. The strain counts from the static state, in which the overlap is ``rest`` and the force ``load``.
Whatever holds the beads there (forces on the ends, walls, gravity) is constant, and so part of the law: what a link
adds to it is all that moves the beads. Nesterenko, chapter 1.
"""

from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from lammps_inputs import engine_limits
from lammps_inputs.deck_lines import BeadLayout, DeckLines, types_by_contact
from lammps_inputs.laws import Law, Parameter, Pure, contact_lines, formula
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension

_NEWTON = 60

_NEAR, _TERMS = 0.1, 14
"""Strain over the overlap at rest up to which an energy is its series, to the last digit with so many terms."""

LEAST_OVERLAP = 1e-300
"""Overlap in place of 0 in slopes, of which any power is a number: absent links have the exponent 0."""


class Hertz(Law):
    """``A (s)+^1.5`` with the overlap as strain (Starosvetsky, Hasan & Vakakis, eq. 1: A = 1)."""

    strength: Pure = 1.0
    """A, in units of the scale's contact constant."""
    exponent = 1.5
    wall = contact_lines.wall_of_power

    @staticmethod
    def force(s: Any, strength: Any) -> Any:
        """Repulsion at an overlap; none where the beads are apart."""
        closed = np.maximum(s, 0.0)
        return strength * (closed * np.sqrt(closed))

    @staticmethod
    def energy(s: Any, strength: Any) -> Any:
        """``2/5 A (s)+^2.5``."""
        closed = np.maximum(s, 0.0)
        return strength * (0.4 * closed * closed * np.sqrt(closed))

    @staticmethod
    def stiffness(s: Any, strength: Any) -> Any:
        """``3/2 A (s)+^0.5``."""
        return strength * (1.5 * np.sqrt(np.maximum(s, 0.0)))

    @staticmethod
    def max_strain(energy: Any, strength: Any) -> Any:
        """Overlap at which one contact holds all of the energy; 0 where there is no contact."""
        return (2.5 * energy / np.where(np.asarray(strength) > 0.0, strength, np.inf)) ** 0.4

    def overlap_under(self, load: Parameter) -> Any:
        """Overlap at which a contact has a force, of its shape; 0 where there is no contact."""
        return np.cbrt(over_strength(self.strength, load)) ** 2

    def pressed_to(self, rest: Parameter) -> "Preloaded":
        """Law of contacts with an overlap at rest, and the force that the law has there, to the last bit."""
        return Preloaded(self.strength, rest, plain(self.strength * (rest * np.sqrt(rest))))

    def along(self, _name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS's Hertz force is ``Kn * sqrt(diameter / 4) * overlap**1.5`` for equal beads.

        Diameters in LAMMPS are equal even where those of the beads are not, so that beads touch exactly. Contacts
        that differ are distinguished by the types of their beads, which takes another pair style and 1.7 times
        the time of a step.
        """
        unit = float(1.0 / np.sqrt(layout.diameter / 4.0))
        if layout.contact_loss is not None or np.ndim(self.strength) > 0:
            return contact_lines.granular("hertz", unit, self.strength, "overlap^1.5", layout)
        return DeckLines(
            interactions=(
                "# contacts: force = overlap^1.5, no friction, no loss; this style computes no energy",
                f"pair_style gran/hertz/history {unit * float(self.strength)!r} 0 0 0 0 0",
                "pair_coeff * *",
            )
        )


class Power(Law):
    """``A (s)+^p`` with the overlap as strain, p >= 1."""

    strength: Pure
    """A, in units of the scale's contact constant."""
    exponent: Pure
    """p, a number or [chain, contact]."""
    wall = contact_lines.wall_of_power

    @staticmethod
    def force(s: Any, strength: Any, exponent: Any) -> Any:
        """Repulsion at an overlap; none where the beads are apart."""
        return strength * np.maximum(s, 0.0) ** exponent

    @staticmethod
    def energy(s: Any, strength: Any, exponent: Any) -> Any:
        """``A (s)+^(p + 1) / (p + 1)``."""
        return strength * np.maximum(s, 0.0) ** (exponent + 1.0) / (exponent + 1.0)

    @staticmethod
    def stiffness(s: Any, strength: Any, exponent: Any) -> Any:
        """``p A (s)+^(p - 1)``; with p = 1 it jumps where the beads touch."""
        return strength * (exponent * np.maximum(s, LEAST_OVERLAP) ** (exponent - 1.0)) * (np.asarray(s) > 0.0)

    @staticmethod
    def max_strain(energy: Any, strength: Any, exponent: Any) -> Any:
        """Overlap at which one contact holds all of the energy; 0 where there is no contact."""
        strong = np.where(np.asarray(strength) > 0.0, strength, np.inf)
        return ((exponent + 1.0) * energy / strong) ** (1.0 / (exponent + 1.0))

    def overlap_under(self, load: Parameter) -> Any:
        """Overlap at which a contact has a force, of its shape; 0 where there is no contact."""
        return over_strength(self.strength, load) ** (1.0 / self.exponent)

    def pressed_to(self, rest: Parameter) -> "PreloadedPower":
        """Law of contacts with an overlap at rest, never quite 0, and the force there."""
        return PreloadedPower(self.strength, self.exponent, *_power_at(self, rest))

    def along(self, name: str, layout: BeadLayout) -> DeckLines:
        """Linear contacts are a style of LAMMPS's own; others it has from a formula of the energy, eight times slower.

        Raises:
            EngineLimitError: contacts that differ, of exponents other than 1, or 1 and 1.5.
        """
        if np.ndim(self.exponent) > 0:
            return self._by_contact(name, layout)
        p = float(self.exponent)
        if np.ndim(self.strength) > 0:
            if p != 1.0:
                raise engine_limits.STRENGTHS.error(name, p)
            return contact_lines.granular("hooke", 1.0, self.strength, "overlap", layout)
        if p == 1.0 and layout.contact_loss is not None and layout.contact_loss.each_pair:
            return contact_lines.granular("hooke", 1.0, self.strength, "overlap", layout)
        if p == 1.0:
            return DeckLines(
                interactions=(
                    "# contacts: force = overlap, no friction, no loss; this style computes no energy",
                    f"pair_style gran/hooke {text(float(self.strength))} 0 0 0 0 0",
                    "pair_coeff * *",
                )
            )
        energy = f"{text(float(self.strength) / (p + 1.0))}*({text(layout.diameter)}-r)^{text(p + 1.0)}"
        return formula.contacts(energy, f"= overlap^{text(p)}, from its energy", layout)

    def _by_contact(self, name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS distinguishes contacts by the types of their beads; it has two exponents for that."""
        words = {1.0: ("hooke", 1.0), 1.5: ("hertz", float(1.0 / np.sqrt(layout.diameter / 4.0)))}
        power = np.asarray(self.exponent)
        if others := sorted(set(power.reshape(-1).tolist()) - set(words)):
            raise engine_limits.EXPONENTS.error(name, others[0])
        both = np.stack(np.broadcast_arrays(self.strength, power), axis=-1)
        kinds, kind = np.unique(both.reshape(-1, 2), axis=0, return_inverse=True)
        types = types_by_contact(kind.reshape(power.shape).astype(np.float64), closed=layout.closed)
        law = [f"{words[p][0]} {text(words[p][1] * a)}" for a, p in kinds.tolist()]
        models = {pair: law[int(number)] for pair, number in types.strength.items()}
        return contact_lines.of_types(law[0], (types, models), "overlap^exponent, both by the bead types", layout)


class Preloaded(Law):
    """``A (d0 + s)+^1.5 - F0`` with ``F0 = A d0^1.5``."""

    strength: Pure
    """A, in units of the scale's contact constant."""
    rest: Annotated[Parameter, Dimension("length")]
    """d0, the overlap at rest."""
    load: Annotated[Parameter, Dimension("force")]
    """F0, to the last bit what the first term is at s = 0."""
    exponent = 1.5
    wall = contact_lines.wall_of_power

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
    wall = contact_lines.wall_of_power

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


def under(law: Law, load: Parameter, grid: float) -> Any:
    """The contact that carries a load at rest, as nearly as places that are multiples of ``grid`` allow.

    Args:
        law: law of the contact without load.
        load: force at rest, a number or an array of the law's shape; 0 where there is none.
        grid: distance that LAMMPS can distinguish; overlaps at rest are multiples of it, and loads follow from them.
    """
    return law.pressed_to(plain(np.round(law.overlap_under(load) / grid) * grid))


def pressed(law: Any, factor: float) -> Any:
    """Law of a contact or wall under its static load times a factor."""
    rest, load = _power_at(law, law.rest * factor ** (1.0 / law.exponent))
    return replace(law, rest=rest, load=load)


def _power_at(law: Any, rest: Parameter) -> tuple[Parameter, Parameter]:
    """Overlap at rest, never quite 0, and the force there."""
    rest = np.maximum(rest, _LEAST) if np.ndim(rest) else max(float(rest), _LEAST)
    return rest, law.strength * rest**law.exponent


def over_strength(strength: Parameter, load: Parameter) -> Any:
    """A load over the strength of its contact, of their shape; 0 where there is no contact."""
    present = np.asarray(strength) > 0.0
    return np.where(present, np.asarray(load) / np.where(present, strength, 1.0), 0.0)


def plain(value: Any) -> Parameter:
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
