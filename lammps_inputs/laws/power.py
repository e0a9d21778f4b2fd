"""A contact whose force is any power of the overlap, and which only ever pushes: ``strength * overlap**exponent``.

Nesterenko, Dynamics of Heterogeneous Materials (Springer, 2001), 1.2: chains of any exponent above 1 are sonic vacua.
"""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lammps_inputs.laws import Parameter, dashpot
from lammps_inputs.lines import Lines
from lammps_inputs.numbers import text

if TYPE_CHECKING:
    from lammps_inputs.layout import Layout

_SINCE = 20230615
"""Earlier releases of LAMMPS have no contacts from a formula of beads' radii."""


class Power(NamedTuple):
    """``A (s)+^p`` with the overlap as strain, p >= 1."""

    strength: Parameter
    """A, in units of the scale's contact constant."""
    exponent: float
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
        elastic = self._linear() if self.exponent == 1.0 else self._by_formula(text(layout.diameter))
        if layout.contact_loss is None:
            return elastic
        says, *lines = elastic.interactions
        variables, beside = dashpot.alone(layout)
        return replace(
            elastic,
            variables=(*elastic.variables, *variables),
            interactions=(says.replace("no loss", "with a dashpot beside it"), *lines),
            beside=beside,
        )

    def _linear(self) -> Lines:
        return Lines(
            interactions=(
                "# contacts: force = overlap, no friction, no loss (LAMMPS reports no energy for this style)",
                f"pair_style gran/hooke {text(float(self.strength))} 0 0 0 0 0",
                "pair_coeff * *",
            )
        )

    def _by_formula(self, diameter: str) -> Lines:
        power = self.exponent + 1.0
        factor = text(float(self.strength) / power)
        return Lines(
            variables=(
                f'if "$(version) < {_SINCE}" then "print \'contacts of any exponent need LAMMPS of 15Jun2023 or later'
                '\'" "quit 1"',
            ),
            interactions=(
                f"# contacts: force = overlap^{text(self.exponent)}, from its energy; no friction, no loss",
                f"pair_style lepton/sphere {diameter}",
                f'pair_coeff * * "{factor}*({diameter}-r)^{text(power)}"',
            ),
        )
