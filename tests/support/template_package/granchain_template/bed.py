"""Beads on a bed of springs of the fifth power: a law, its spelling in LAMMPS, and the ingredient that uses it."""

from typing import Annotated, Any

from pydantic import Field

from granchain.parts import Fact, Ingredient, Links, Setting, formula, laws, units


class Quintic(laws.Law):
    """``q s**5``."""

    quintic: Annotated[laws.Parameter, units.Dimension("stiffness", length=-4)]

    @staticmethod
    def force(s: Any, quintic: Any) -> Any:
        """Force at a displacement."""
        return quintic * (s * s * s * s * s)

    @staticmethod
    def energy(s: Any, quintic: Any) -> Any:
        """Energy at a displacement."""
        return quintic / 6.0 * s**6

    @staticmethod
    def stiffness(s: Any, quintic: Any) -> Any:
        """Slope of the force."""
        return 5.0 * quintic * s**4

    @staticmethod
    def max_strain(energy: Any, quintic: Any) -> Any:
        """Displacement at which a spring holds an energy."""
        return (6.0 * energy / quintic) ** (1.0 / 6.0)

    ground = formula.ground("quintic*s^5")


class Bed(Ingredient):
    """Springs of the fifth power from every bead to the ground."""

    takes_away = frozenset({Fact.MOMENTUM, Fact.PULSE})

    quintic: Annotated[float, Field(gt=0), units.Unit("N/m5")]
    """Force over the fifth power of the displacement."""

    def links(self, setting: Setting) -> tuple[Links, ...]:
        """One spring at each bead."""
        return (Links.ground("bed", laws.dimensionless(Quintic(self.quintic), setting.scale)),)
