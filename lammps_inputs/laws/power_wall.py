"""A bead that is pressed against something at rest with a force that is any power of the overlap: `power` at a wall."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Parameter
from lammps_inputs.laws.power import Power
from lammps_inputs.laws.wall import wall_lines
from lammps_inputs.lines import Lines

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout


class PowerWall(NamedTuple):
    """``A (s - gap)+^p`` against a wall on the right, the mirror image of that against one on the left; p >= 1."""

    strength: Parameter
    """A, in units of the scale's contact constant; 0 for beads that have no wall."""
    exponent: float
    """p."""
    side: float
    """1 for a wall towards higher bead numbers, -1 towards lower ones."""
    gap: float
    """Clear distance at rest."""

    @staticmethod
    def force(s: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """Repulsion by the wall; none where the bead is off it."""
        return side * strength * np.maximum(side * s - gap, 0.0) ** exponent

    @staticmethod
    def energy(s: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """As of `Power`."""
        return Power.energy(side * s - gap, strength, exponent)

    @staticmethod
    def stiffness(s: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """As of `Power`."""
        return Power.stiffness(side * s - gap, strength, exponent)

    @staticmethod
    def reach(energy: Any, strength: Any, exponent: Any, side: Any, gap: Any) -> Any:
        """Displacement at which one contact holds the whole energy; 0 where there is none."""
        overlap = Power.reach(energy, strength, exponent)
        return np.where(overlap > 0.0, side * (gap + overlap), 0.0)

    def overlap(self, energy: float) -> Any:
        """The overlap at which one contact holds the whole energy."""
        return np.abs(self.reach(energy, *self)) - self.gap

    def opposite(self) -> "PowerWall":
        """The same on the other side."""
        return self._replace(side=-self.side)

    def ground(self, name: str, layout: "Layout") -> Lines:
        """A wall as far away as the gap."""
        return wall_lines(name, self, layout)
