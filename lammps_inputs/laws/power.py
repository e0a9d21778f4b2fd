"""A contact whose force is any power of the overlap, and which only ever pushes: ``strength * overlap**exponent``.

Nesterenko, Dynamics of Heterogeneous Materials (Springer, 2001), 1.2: chains of any exponent above 1 are sonic vacua.
"""

from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Pure, formula
from lammps_inputs.lines import Lines
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout


class Power(NamedTuple):
    """``A (s)+^p`` with the overlap as strain, p >= 1."""

    strength: Pure
    """A, in units of the scale's contact constant."""
    exponent: Annotated[float, Dimension()]
    """p."""

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
        return strength * (exponent * np.maximum(s, 0.0) ** (exponent - 1.0)) * (np.asarray(s) > 0.0)

    @staticmethod
    def reach(energy: Any, strength: Any, exponent: Any) -> Any:
        """Overlap at which one contact holds the whole energy; 0 where there is none."""
        strong = np.where(np.asarray(strength) > 0.0, strength, np.inf)
        return ((exponent + 1.0) * energy / strong) ** (1.0 / (exponent + 1.0))

    def along(self, name: str, layout: "Layout") -> Lines:
        """Linear contacts are a style of LAMMPS's own; others it has from a formula of the energy, eight times slower.

        Raises:
            ValueError: contacts that differ.
        """
        if np.ndim(self.strength) > 0:
            raise ValueError(f"{name}: LAMMPS has one strength for contacts of this law; use the reference engine")
        return self._linear() if self.exponent == 1.0 else self._by_formula(layout)

    def _linear(self) -> Lines:
        return Lines(
            interactions=(
                "# contacts: force = overlap, no friction, no loss (LAMMPS reports no energy for this style)",
                f"pair_style gran/hooke {text(float(self.strength))} 0 0 0 0 0",
                "pair_coeff * *",
            )
        )

    def _by_formula(self, layout: "Layout") -> Lines:
        power = self.exponent + 1.0
        energy = f"{text(float(self.strength) / power)}*({text(layout.diameter)}-r)^{text(power)}"
        return formula.contacts(energy, f"= overlap^{text(self.exponent)}, from its energy", layout)
