"""A foundation: every bead is held at its place by a spring, as in a chain that lies in an elastic matrix.

Beats between chains on foundations, and their targeted transfer of energy: Starosvetsky, Hasan, Vakakis & Manevitch,
SIAM J. Appl. Math. 72 (2012); Hasan et al., Granular Matter 15 (2013).
"""

from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from lammps_inputs import laws, strict_yaml
from lammps_inputs.deck_lines import MOST_GROUPS
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.laws import Law
from lammps_inputs.laws.spring import Duffing, Linear
from lammps_inputs.links import Ground
from lammps_inputs.units import Unit

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene

Stiffness = Annotated[float, Field(ge=0, le=1e30), Unit("N/m")]
Cubic = Annotated[float, Field(ge=0, le=1e30), Unit("N/m3")]
Row = Annotated[int, Field(ge=1, le=10**8)]

MOST = 1e12
"""Dimensionless stiffness; beyond it the beads do not move."""


class Foundation(Ingredient):
    """Springs from the beads to the ground: a force ``-stiffness x - cubic x**3``."""

    example: ClassVar[str] = "{stiffness: 0.1}"
    sources = ("starosvetsky2012",)

    takes_away = frozenset({Fact.MOMENTUM, Fact.PULSE, Fact.FRONT})
    why = MappingProxyType({Fact.FRONT: "beads behind a window keep oscillating"})

    stiffness: Stiffness | tuple[Stiffness, ...] = 0.0
    """Linear stiffness k of all chains, or a list with one for each chain."""
    cubic: Cubic | tuple[Cubic, ...] = 0.0
    """Cubic stiffness c of all chains, or a list with one for each chain."""
    rows: tuple[Row, Row] | None = None
    """First and last bead with springs; all beads if omitted."""

    _from_list = field_validator("stiffness", "cubic", "rows", mode="before")(strict_yaml.as_tuple)

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse what does not fit the chains."""
        for key in ("stiffness", "cubic"):
            given = getattr(self, key)
            if isinstance(given, tuple) and len(given) != scene.chains:
                raise ValueError(
                    f"foundation.{key}: {len(given)} numbers for {scene.chains} chains; one, or one for each"
                )
            if isinstance(given, tuple) and len(set(given)) > MOST_GROUPS:
                raise ValueError(f"foundation.{key}: LAMMPS has {MOST_GROUPS} groups for different values")
        for link in self.links(scene):
            for key, values in zip(("stiffness", "cubic"), link.law, strict=False):
                if np.max(values) > MOST:
                    raise ValueError(
                        f"foundation.{key}: so stiff that the beads do not move; at most 1e12, dimensionless"
                    )
        if self.rows is not None and not self.rows[0] <= self.rows[1] <= scene.beads:
            first, last = self.rows
            raise ValueError(
                f"foundation.rows: {first} to {last} given; from a bead to a later one, within {scene.beads}"
            )

    def links(self, scene: "BaseScene") -> tuple[Ground, ...]:
        """One spring a bead; linear where it is."""
        stiffness, cubic = self._values("stiffness", scene), self._values("cubic", scene)
        law: Law = Duffing(stiffness, cubic) if np.any(cubic) else Linear(stiffness)
        return (
            (Ground("foundation", laws.dimensionless(law, scene.scale)),) if np.any(stiffness) or np.any(cubic) else ()
        )

    def _values(self, key: str, scene: "BaseScene") -> float | NDArray[np.float64]:
        """A number, or [chain, bead] where it differs, in the scene's units."""
        given = getattr(self, key)
        if self.rows is None and (not isinstance(given, tuple) or len(set(given)) == 1):
            return float(np.max(given))
        values = np.zeros((scene.chains, scene.beads))
        first, last = self.rows or (1, scene.beads)
        values[:, first - 1 : last] = np.array(given).reshape(-1, 1)
        return values
