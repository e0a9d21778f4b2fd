"""Weights: a constant force on every bead, in proportion to its mass."""

# ruff: noqa: ARG004  every function of a law takes all of its parameters
from typing import Annotated, Any

import numpy as np

from lammps_inputs.deck_lines import BeadLayout, DeckLines, atoms_by_value
from lammps_inputs.laws import Law, Parameter, Pure
from lammps_inputs.numbers import text
from lammps_inputs.units import Dimension


class Weight(Law):
    """``-m g``: the force of a link drives its bead back, and weights drive beads forward."""

    constant = True

    acceleration: Annotated[Parameter, Dimension("velocity", over="time")]
    """g, in units of V / T."""
    mass: Pure
    """Mass of each bead over that of the reference bead."""

    @staticmethod
    def force(s: Any, acceleration: Any, mass: Any) -> Any:
        """Force against the displacement, independent of it."""
        return -mass * acceleration + 0.0 * s

    @staticmethod
    def energy(s: Any, acceleration: Any, mass: Any) -> Any:
        """``-m g s``."""
        return -mass * acceleration * s

    @staticmethod
    def stiffness(s: Any, acceleration: Any, mass: Any) -> Any:
        """Slope of the force: none."""
        return 0.0 * s

    @staticmethod
    def max_strain(energy: Any, acceleration: Any, mass: Any) -> Any:
        """0, as no energy bounds how far a bead falls."""
        return 0.0 * np.asarray(mass)

    def ground(self, name: str, layout: BeadLayout) -> DeckLines:
        """LAMMPS commands of the weights: by its masses, or as forces where its masses are not those of the beads."""
        if not layout.velocity_at_full_steps:
            return DeckLines(
                variables=(f"variable {name} index {text(float(np.max(self.acceleration)))}",),
                motion=(f"fix {name} {layout.group} gravity ${{{name}}} vector 1 0 0",),
            )
        weights = (np.asarray(self.mass) * self.acceleration,)
        lines: list[str] = []
        for number, ((weight,), atoms) in enumerate(atoms_by_value(name, weights, (layout.chains, layout.beads)), 1):
            lines += [
                f"group {name}{number} id {atoms}",
                f"fix {name}{number} {name}{number} addforce {text(weight)} 0.0 0.0",
            ]
        return DeckLines(motion=tuple(lines))
