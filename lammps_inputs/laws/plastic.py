"""Contacts that yield: their force depends on the largest overlap so far, their state.

`Thornton` is that of elastic, perfectly plastic spheres (Thornton, J. Appl. Mech. 64, 383, 1997): Hertz's up to the
overlap at which the contact yields, then along the tangent there; unloading and reloading follow Hertz's law of a
larger radius. `WaltonBraun` loads and unloads along two straight lines (Walton & Braun, J. Rheol. 30, 949, 1986).

Overlaps include that at rest, the largest so far too: under a static load it begins with the overlap at rest.
"""

from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from lammps_inputs.deck_lines import BeadLayout, DeckLines
from lammps_inputs.laws import ContactState, Law, Parameter, Pure, plastic_lines
from lammps_inputs.laws.contact import over_strength
from lammps_inputs.units import Dimension

YIELD_PRESSURE = 1.6
"""Peak pressure over the yield strength where a metal (Poisson's ratio 0.3) begins to flow, below the surface at 0.48
contact radii (Johnson, Contact Mechanics, 1985, 6.1, Tresca or von Mises).
"""

Length = Annotated[Parameter, Dimension("length")]

ROUNDING = 1e-9
"""Difference from the largest overlap so far, far above rounding, within which an overlap counts as the largest."""


class LargestSoFar(ContactState):
    """Largest overlap so far, as the state of a contact: beyond it first loading continues, below it unloads."""

    heading, meaning = "v_memory", "largest overlap so far"

    def turning_overlap(self, state: Any) -> Any:
        """Overlap, [...], at which unloading began: the state itself."""
        return state

    def loading(self, state: Any, overlap: Any, closing: Any) -> Any:
        """Whether contacts close at their largest overlap, [...]."""
        return (closing > 0.0) & (overlap >= state - ROUNDING)

    def on_branch(self, state: Any, closing: Any) -> Any:
        """State, [...], a little less than the largest overlap where contacts close, and more where they open."""
        return state - ROUNDING * np.sign(closing)


LargestOverlap = Annotated[Parameter, Dimension("length"), LargestSoFar()]
"""Type of the parameter that is the largest overlap so far, 0 at the start."""


class Thornton(Law):
    """Force ``A (delta - delta_r)^1.5 / z^0.5``, with the permanent overlap ``delta_r = delta_m (1 - z)``.

    The largest overlap so far is delta_m, or delta_y where that is larger, and ``z = w^0.5 (1.5 - 0.5 w)`` with
    ``w = delta_y / delta_m``. While delta is the largest overlap so far, the force is that of first loading,
    ``A delta^1.5`` up to delta_y and ``A delta_y^0.5 (1.5 delta - 0.5 delta_y)`` beyond.
    """

    strength: Pure
    """A, in units of the scale's contact constant."""
    onset: Length
    """delta_y, the overlap at which the contact yields."""
    largest: LargestOverlap = 0.0
    """delta_m, the largest overlap so far."""
    rest: Length = 0.0
    """Overlap at rest."""
    load: Annotated[Parameter, Dimension("force")] = 0.0
    """Force at rest."""

    @staticmethod
    def force(s: Any, strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:
        """Repulsion above that at rest; below it where the beads are farther apart."""
        d = rest + s
        top = np.maximum(np.maximum(largest, d), onset)
        w = onset / top
        z = np.sqrt(w) * (1.5 - 0.5 * w)
        c = np.maximum(d - top * (1.0 - z), 0.0)
        return strength * (c * np.sqrt(c / z)) - load

    @staticmethod
    def energy(s: Any, strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:
        """Energy that unloading returns, ``2/5 A (delta - delta_r)^2.5 / z^0.5``, less that at rest and ``load s``."""
        stored = _stored(rest + s, strength, onset, np.maximum(largest, rest + s))
        return stored - _stored(rest, strength, onset, rest) - load * s

    @staticmethod
    def stiffness(s: Any, strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """``3/2 A ((delta - delta_r) / z)^0.5``; of first loading beyond yield ``3/2 A delta_y^0.5``."""
        d = rest + s
        c, z = _unloading(d, onset, np.maximum(largest, d))
        first = (d >= largest) & (d > onset)
        return 1.5 * strength * np.where(first, np.sqrt(onset), np.sqrt(c / z))

    @staticmethod
    def max_strain(energy: Any, strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """Strain at which first loading from rest has taken all of the energy; 0 where there is no contact."""
        present = np.asarray(strength) > 0.0
        a, y = np.where(present, strength, 1.0), onset
        begin = np.maximum(rest, y)
        # until it yields: at most that without load
        elastic = (2.5 * energy / a) ** 0.4
        held = 0.4 * a * (y**2.5 - np.minimum(rest, y) ** 2.5) - load * (begin - rest)
        # beyond: 3/4 A delta_y^1/2 x^2 + (F(begin) - load) x = energy - held
        more = np.maximum(energy - np.maximum(held, 0.0), 0.0)
        half = 0.5 * np.maximum(a * np.sqrt(y) * (1.5 * begin - 0.5 * y) - load, 0.0)
        curve = 0.75 * a * np.sqrt(y)
        x = more / (half + np.sqrt(half * half + curve * more))
        return np.where(present, np.where(more > 0.0, begin - rest + x, np.minimum(begin - rest, elastic)), 0.0)

    @staticmethod
    def stiffest(energy: Any, strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:
        """Stiffness of unloading from the largest overlap, ``3/2 A delta_m^0.5``."""
        return 1.5 * strength * np.sqrt(rest + Thornton.max_strain(energy, strength, onset, largest, rest, load))

    @staticmethod
    def next_state(s: Any, strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """Largest overlap so far after a strain."""
        return np.maximum(largest, rest + s)

    @staticmethod
    def dissipated(strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """Energy dissipated since the start: work of first loading up to delta_m, less what unloading gives back."""
        return _lost(strength, onset, largest) - _lost(strength, onset, rest)

    @staticmethod
    def permanent(strength: Any, onset: Any, largest: Any, rest: Any, load: Any) -> Any:  # noqa: ARG004
        """Overlap at which unloading ends, delta_r."""
        return np.maximum(largest, onset) - _unloading(np.maximum(largest, onset), onset, largest)[0]

    @staticmethod
    def restitution_at(velocity: Any, yield_velocity: Any) -> Any:
        """Restitution of two spheres that meet at a velocity, [...]; 1 up to that at which they yield.

        Args:
            velocity: [...] relative velocity with which they approach.
            yield_velocity: that from which they yield, ``(0.8 A delta_y^2.5 / mu)^0.5`` with the reduced mass.

        Examples:
            >>> Thornton.restitution_at(np.array([0.5, 1.0, 10.0]), yield_velocity=1.0).round(3)
            array([1.   , 1.   , 0.659])
        """
        q = np.minimum(np.asarray(yield_velocity) / velocity, 1.0)
        square = q * q
        tail = q / (q + 2.0 * np.sqrt(1.2 - 0.2 * square))
        return np.where(q < 1.0, np.sqrt(1.2 * np.sqrt(3.0) * (1.0 - square / 6.0)) * tail**0.25, 1.0)

    def overlap_under(self, load: Parameter) -> Any:
        """Overlap at which first loading reaches a force, of its shape; 0 where there is no contact."""
        bare = over_strength(self.strength, load)
        beyond = (bare / np.sqrt(self.onset) + 0.5 * self.onset) / 1.5
        return np.where(bare > self.onset**1.5, beyond, np.cbrt(bare) ** 2)

    def pressed_to(self, rest: Parameter) -> "Thornton":
        """Law of contacts whose overlap at rest, a number or [chain, contact], is their largest so far."""
        alone = replace(self, largest=rest, rest=rest)
        return replace(alone, load=alone.force(0.0, *alone))

    def at_wall(self, _name: str, _layout: BeadLayout) -> DeckLines:
        """No LAMMPS commands of a wall by itself: those of the contacts have it (`along`)."""
        return DeckLines()

    def along(self, name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS commands of the contacts and of the walls, see `lammps_inputs.laws.plastic_lines`."""
        return plastic_lines.contacts(self, name, layout)


class WaltonBraun(Law):
    """``A delta`` while delta is the largest overlap so far, else ``A (d - (1 - e^2) delta_m)+ / e^2``."""

    strength: Pure
    """A, in units of the scale's contact constant."""
    restitution: Pure
    """e."""
    largest: LargestOverlap = 0.0
    """delta_m, the largest overlap so far."""

    @staticmethod
    def force(s: Any, strength: Any, restitution: Any, largest: Any) -> Any:
        """Repulsion at an overlap."""
        square = restitution * restitution
        return strength * (np.maximum(s - (1.0 - square) * np.maximum(np.maximum(largest, s), 0.0), 0.0) / square)

    @staticmethod
    def energy(s: Any, strength: Any, restitution: Any, largest: Any) -> Any:
        """Energy that unloading gives back."""
        square = restitution * restitution
        left = np.maximum(s - (1.0 - square) * np.maximum(np.maximum(largest, s), 0.0), 0.0)
        return 0.5 * strength * left * left / square

    @staticmethod
    def stiffness(s: Any, strength: Any, restitution: Any, largest: Any) -> Any:
        """``A``, and ``A / e^2`` below the largest overlap."""
        square = restitution * restitution
        closed = s > (1.0 - square) * np.maximum(np.maximum(largest, s), 0.0)
        return strength * np.where(s >= largest, 1.0, 1.0 / square) * closed

    @staticmethod
    def max_strain(energy: Any, strength: Any, restitution: Any, largest: Any) -> Any:  # noqa: ARG004
        """Overlap at which first loading has taken all of the energy; 0 where there is no contact."""
        return np.sqrt(2.0 * energy / np.where(np.asarray(strength) > 0.0, strength, np.inf))

    @staticmethod
    def stiffest(energy: Any, strength: Any, restitution: Any, largest: Any) -> Any:  # noqa: ARG004
        """Stiffness of unloading, ``A / e^2``."""
        return strength / (restitution * restitution)

    @staticmethod
    def next_state(s: Any, strength: Any, restitution: Any, largest: Any) -> Any:  # noqa: ARG004
        """Largest overlap so far after a strain."""
        return np.maximum(largest, s)

    @staticmethod
    def dissipated(strength: Any, restitution: Any, largest: Any) -> Any:
        """Energy dissipated since the start, ``A (1 - e^2) delta_m^2 / 2``."""
        return 0.5 * strength * (1.0 - restitution * restitution) * np.maximum(largest, 0.0) ** 2

    @staticmethod
    def permanent(strength: Any, restitution: Any, largest: Any) -> Any:  # noqa: ARG004
        """Overlap at which unloading ends."""
        return (1.0 - restitution * restitution) * np.maximum(largest, 0.0)


def _unloading(d: Any, onset: Any, largest: Any) -> tuple[Any, Any]:
    """Overlap beyond the permanent one, and z of `Thornton`."""
    top = np.maximum(largest, onset)
    w = onset / top
    z = np.sqrt(w) * (1.5 - 0.5 * w)
    return np.maximum(d - top * (1.0 - z), 0.0), z


def _stored(d: Any, strength: Any, onset: Any, largest: Any) -> Any:
    c, z = _unloading(d, onset, largest)
    return 0.4 * strength * (c * c * np.sqrt(c / z))


def _lost(strength: Any, onset: Any, largest: Any) -> Any:
    top = np.maximum(largest, onset)
    x = top - onset
    work = 0.4 * onset**2.5 + x * (onset**1.5 + 0.75 * np.sqrt(onset) * x)
    return strength * work - _stored(top, strength, onset, largest)
