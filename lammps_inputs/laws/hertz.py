"""The contact of two elastic spheres: a force ``strength * overlap**1.5`` that only ever pushes (Hertz 1882)."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Parameter
from lammps_inputs.lines import Lines

if TYPE_CHECKING:
    from lammps_inputs.problem import System


class Hertz(NamedTuple):
    """``A (s)+^1.5`` with the overlap as strain (Starosvetsky, Hasan & Vakakis, eq. 1: A = 1)."""

    strength: Parameter = 1.0
    """A, in units of the scale's contact constant."""

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
    def reach(energy: Any, strength: Any) -> Any:
        """Overlap at which one contact holds the whole energy; 0 where there is none."""
        return (2.5 * energy / np.where(np.asarray(strength) > 0.0, strength, np.inf)) ** 0.4

    def along(self, _name: str, problem: "System") -> Lines:
        """LAMMPS's Hertz force is ``Kn * sqrt(diameter / 4) * overlap**1.5`` for equal beads."""
        return Lines(
            interactions=(
                "# contacts: force = overlap^1.5, no friction, no loss (LAMMPS reports no energy for this style)",
                f"pair_style gran/hertz/history {float(1.0 / np.sqrt(problem.diameter / 4.0))!r} 0 0 0 0 0",
                "pair_coeff * *",
            )
        )
