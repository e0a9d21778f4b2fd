"""The dashpot of a bead that is pressed against a wall: one of the contacts' (`dashpot`), on one side.

A law of damping, with the displacement of the bead as strain. It may be any of the three, so that coefficients of two
are 0.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Parameter
from lammps_inputs.laws.dashpot import LEAST

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout


class WallDashpot(NamedTuple):
    """``(g + b o**0.5 + a o**0.25) s'`` at an overlap ``o = side s + rest`` above 0; see `ContactDashpot` and so on."""

    steady: Parameter
    """g, in units of m / T; 0 for beads that have no wall, and so with the others."""
    by_radius: Parameter
    """b, in units of m / (T L**0.5)."""
    by_stiffness: Parameter
    """a, in units of m / (T L**0.25)."""
    floor: Parameter
    """Strength of the wall where tension is cut, else `NO_FLOOR`."""
    side: float
    """1 for a wall towards higher bead numbers, -1 towards lower ones."""
    rest: Parameter
    """Overlap at rest; below 0 it is a gap."""

    @staticmethod
    def damping(
        s: Any, rate: Any, steady: Any, by_radius: Any, by_stiffness: Any, floor: Any, side: Any, rest: Any
    ) -> Any:
        """As of the contacts."""
        closed = np.maximum(side * s + rest, 0.0)
        root = np.sqrt(closed)
        force = ((closed > 0.0) * steady + by_radius * root + by_stiffness * np.sqrt(root)) * (side * rate)
        return side * np.maximum(force, -floor * (closed * root))

    @staticmethod
    def resistance(s: Any, steady: Any, by_radius: Any, by_stiffness: Any, floor: Any, side: Any, rest: Any) -> Any:  # noqa: ARG004
        """Grows with the overlap."""
        closed = np.maximum(side * s + rest, 0.0)
        root = np.sqrt(closed)
        return (closed > 0.0) * steady + by_radius * root + by_stiffness * np.sqrt(root)

    @staticmethod
    def growth(s: Any, steady: Any, by_radius: Any, by_stiffness: Any, floor: Any, side: Any, rest: Any) -> Any:  # noqa: ARG004
        """Without end where the bead meets the wall, and so cut there."""
        overlap = side * s + rest
        closed = np.maximum(overlap, LEAST)
        root = np.sqrt(closed)
        return side * (overlap > 0.0) * (0.5 * by_radius / root + 0.25 * by_stiffness / (root * np.sqrt(root)))

    @staticmethod
    def impulse(s: Any, steady: Any, by_radius: Any, by_stiffness: Any, floor: Any, side: Any, rest: Any) -> Any:  # noqa: ARG004
        """Nothing at rest, to the last bit, with and without a gap."""
        closed, base = np.maximum(side * s + rest, 0.0), np.maximum(rest, 0.0)
        root, low = np.sqrt(closed), np.sqrt(base)
        linear = np.maximum(side * s, -rest) - np.maximum(0.0, -rest)
        viscous = 2.0 / 3.0 * (closed * root - base * low)
        return side * (
            steady * linear
            + by_radius * viscous
            + by_stiffness * (0.8 * closed * np.sqrt(root) - 0.8 * base * np.sqrt(low))
        )

    @property
    def coefficient(self) -> Any:
        """That of its kind."""
        return self.steady + self.by_radius + self.by_stiffness

    def opposite(self) -> "WallDashpot":
        """The same on the other side."""
        return self._replace(side=-self.side)

    def granular(self, layout: "Layout") -> tuple[list[float], str]:
        """LAMMPS's coefficient for the wall of every chain, and the model, which is that of the contacts.

        Viscoelastic ones it multiplies by the bead's mass and the contact's radius, sqrt(diameter / 2 * overlap).
        Restitution it makes of strengths and masses itself.
        """
        assert layout.contact_loss is not None
        share, model = layout.contact_loss.granular(layout)
        of_chain = np.max(np.broadcast_to(self.coefficient, (layout.chains, layout.beads)), axis=1)
        if "restitution" in model:
            of_chain = np.full(layout.chains, share)
        elif "viscoelastic" in model:
            of_chain = of_chain / (np.max(layout.system.mass) * np.sqrt(layout.diameter / 2.0))
        return of_chain.tolist(), model
