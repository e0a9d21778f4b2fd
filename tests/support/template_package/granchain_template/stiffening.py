"""The key `stiffening` of contacts: spheres that stiffen more than Hertz's law, and their law."""

from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from granchain.parts import contact, formula, laws, units


class Stiffening(laws.Law):
    """``A s**1.5 (1 + b s)`` of the overlap s."""

    strength: laws.Pure
    stiffening: Annotated[laws.Parameter, units.Dimension(length=-1)]
    along = formula.along("strength*(0.4*s^2.5+stiffening/3.5*s^3.5)")

    @staticmethod
    def force(s: Any, strength: Any, stiffening: Any) -> Any:
        """Repulsion at an overlap."""
        closed = np.maximum(s, 0.0)
        return strength * (closed * np.sqrt(closed)) * (1.0 + stiffening * closed)

    @staticmethod
    def energy(s: Any, strength: Any, stiffening: Any) -> Any:
        """Energy that is stored at an overlap; the force is its slope."""
        closed = np.maximum(s, 0.0)
        return strength * (0.4 * closed**2.5 + stiffening / 3.5 * closed**3.5)

    @staticmethod
    def stiffness(s: Any, strength: Any, stiffening: Any) -> Any:
        """Slope of the force."""
        closed = np.maximum(s, 0.0)
        return strength * np.sqrt(closed) * (1.5 + 2.5 * stiffening * closed)

    @staticmethod
    def max_strain(energy: Any, strength: Any, stiffening: Any) -> Any:  # noqa: ARG004
        """Overlap within which a contact holds an energy, as Hertz's would; 0 where there is no contact."""
        return (2.5 * energy / np.where(np.asarray(strength) > 0.0, strength, np.inf)) ** 0.4


class StiffeningContact(contact.Contact):
    """A force ``A overlap**1.5 (1 + stiffening overlap)``, with the constant A of spheres."""

    example: ClassVar[str] = "{stiffening: 0.5}"

    key: ClassVar[str] = "stiffening"
    noun: ClassVar[str] = "contacts that stiffen"

    stiffening: Annotated[float, Field(gt=0, le=1e12), units.Unit("1/m"), units.Label("stiffening of the contacts")]
    """Relative increase of the force per overlap."""
    strength: contact.Strength = None

    def contact_law(self, strength: laws.Parameter) -> laws.Law:
        """Law of the contacts, in the scene's units."""
        return Stiffening(strength, self.stiffening)
