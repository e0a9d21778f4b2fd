"""Where LAMMPS has the beads of a system: their diameter, and their places at rest.

The dynamics do not depend on any of it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lammps_inputs import laws, physics
from lammps_inputs.laws.dashpot import ContactLoss, WallDashpot
from lammps_inputs.links import Across
from lammps_inputs.numbers import power_of_two_at_least, text
from lammps_inputs.system import System

PLACES = "places"
"""Fix of LAMMPS that has noted where beads rest, where that is no formula of their numbers."""


@dataclass(frozen=True)
class Layout:
    """Diameter and places of the beads in LAMMPS, and the laws beside a law, for its LAMMPS commands.

    Attributes:
        system: system of the beads.
        window: rows that exist in LAMMPS, where not all do.
    """

    system: System
    window: int | None = None

    @property
    def chains(self) -> int:
        """Number of chains."""
        return self.system.chains

    @property
    def beads(self) -> int:
        """Number of beads of each chain."""
        return self.system.beads

    @property
    def rows(self) -> int:
        """Rows of beads that exist in LAMMPS."""
        return self.window or self.beads

    def atom(self, chain: int, bead: int) -> int:
        """Number of a bead's atom in LAMMPS; all counted from 1."""
        return (chain - 1) * self.rows + bead

    @property
    def gap(self) -> float:
        """Clear distance between neighbouring beads; 0 where they touch."""
        return physics.gap(self.system)

    @property
    def contact_loss(self) -> ContactLoss | None:
        """Dashpot law of the contacts; None if they are undamped."""
        return physics.contact_loss(self.system)

    def wall_loss(self, side: float) -> WallDashpot | None:
        """Dashpot law of the walls on a side; None if they are undamped."""
        return physics.wall_loss(self.system, side)

    @property
    def velocity_at_full_steps(self) -> bool:
        """Whether LAMMPS's step is of order 2 by masses that are larger (`lammps_inputs.laws.dashpot.Dashpot`)."""
        return physics.velocity_at_full_steps(self.system)

    @cached_property
    def diameter(self) -> float:
        """Bead diameter: a power of two, so that touching is exact, and never small enough for second neighbours to
        meet or for one overlap to reach half of it.
        """
        system, total = self.system, physics.energy(self.system)
        law, rest = system.along[0].law, float(np.max(laws.rest(system.along[0].law)))
        alone, shared = (rest + laws.max_strain(law, energy) for energy in (total, total / 2.0))
        held = (link.law for link in physics.walls(system))
        walls = (2.0 * float(np.max(laws.rest(law) + law.max_strain(total, *law))) for law in held)
        # dashpots between chains act by the distance of two beads
        damped = any(isinstance(link, Across) and not system.is_tie(link) for link in system.dampers)
        rows = (rest + 2.0 * laws.max_strain(link.law, total) for link in system.couplings if damped)
        least = max(4.0, 2.0 * alone, 2.0 * shared, *walls, *rows)
        return power_of_two_at_least(max(2.0 * least, 4.0 * self.farthest) if 0.0 < self.farthest < np.inf else least)

    @property
    def farthest(self) -> float:
        """How much farther apart than at rest neighbours that act at a distance come, at most; 0 where none do."""
        return physics.farthest(self.system)

    @property
    def diameter_of_others(self) -> float:
        """Diameter of atoms that are no beads, so small that those of two rows, as far apart as beads, never touch."""
        return self.diameter / 8.0

    @property
    def group(self) -> str:
        """LAMMPS's group of all beads."""
        return "all" if physics.lines(self.system) == self.chains else "beads"

    @property
    def spacing(self) -> float:
        """Distance between the centres of neighbouring beads at rest; without load if that differs."""
        rest = float(laws.rest(self.system.along[0].law)) if physics.even(self.system) else 0.0
        return self.diameter + self.gap - rest

    def apart(self, edge: tuple[int, int]) -> float:
        """Lateral distance of the centres of two chains, the lower number first."""
        return 2.0 * (self.diameter + self.gap) * (edge[1] - edge[0])

    @property
    def places(self) -> NDArray[np.float64]:
        """Places of the beads at rest, [chain, bead], in units of L, to the last bit."""
        if physics.even(self.system):
            row = np.arange(1, self.beads + 1) * self.spacing
            return np.broadcast_to(row, (self.chains, self.beads))
        places = np.full((self.chains, self.beads), self.spacing)
        places[:, 1:] -= laws.rest(self.system.along[0].law)
        return np.asarray(np.cumsum(places, axis=1))

    @property
    def place_formula(self) -> str:
        """Place at rest as a formula of LAMMPS in the number of the atom; where there is none, a fix has stored it."""
        return f"((id-1)%{self.rows}+1)*{text(self.spacing)}" if physics.even(self.system) else f"f_{PLACES}"
