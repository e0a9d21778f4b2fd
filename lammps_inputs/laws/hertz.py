"""The contact of two elastic spheres: a force ``strength * overlap**1.5`` that only ever pushes (Hertz 1882)."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Parameter
from lammps_inputs.lines import Lines, types_by_contact
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.problem import System


class Hertz(NamedTuple):
    """``A (s)+^1.5`` with the overlap as strain (Starosvetsky, Hasan & Vakakis, eq. 1: A = 1)."""

    strength: Parameter = 1.0
    """A, in units of the scale's contact constant."""

    @property
    def exponent(self) -> float:
        """Of the overlap, in the force."""
        return 1.5

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
        """LAMMPS's Hertz force is ``Kn * sqrt(diameter / 4) * overlap**1.5`` for equal beads.

        Its diameters are equal even where the beads' are not. So they touch exactly, and contacts that differ are told
        apart by the types of their beads, which takes another pair style: 1.7 times the time of a step.
        """
        unit = float(1.0 / np.sqrt(problem.diameter / 4.0))
        if np.ndim(self.strength) == 0:
            return Lines(
                interactions=(
                    "# contacts: force = overlap^1.5, no friction, no loss (LAMMPS reports no energy for this style)",
                    f"pair_style gran/hertz/history {unit * float(self.strength)!r} 0 0 0 0 0",
                    "pair_coeff * *",
                )
            )
        types = types_by_contact(np.asarray(self.strength))
        no_loss = "0 tangential linear_nohistory 0 0 damping velocity"
        return Lines(
            types=types,
            interactions=(
                "# contacts: force = strength * overlap^1.5, strength by the types of the two; no friction, no loss",
                "pair_style granular",
                f"pair_coeff * * hertz {text(unit)} {no_loss}",
                *(
                    f"pair_coeff {one} {two} hertz {text(unit * a)} {no_loss}"
                    for (one, two), a in types.strength.items()
                ),
            ),
        )
