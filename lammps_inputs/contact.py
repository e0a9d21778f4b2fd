"""Hertzian contact of two equal beads, dimensionless: the force is ``overlap**1.5`` and only ever pushes.

The physics stands beside the LAMMPS lines that mean the same. Plain functions of arrays or scalars, written without
branches so that numba compiles them into vector instructions.
"""

from typing import Any

import numpy as np

from lammps_inputs.numbers import power_of_two_at_least


def force(overlap: Any) -> Any:
    """Repulsion at an overlap (any shape; negative is a gap): ``(overlap)+^1.5`` (Starosvetsky et al., eq. 1)."""
    closed = np.maximum(overlap, 0.0)
    return closed * np.sqrt(closed)


def energy(overlap: Any) -> Any:
    """Elastic energy stored at an overlap: ``2/5 (overlap)+^2.5``."""
    closed = np.maximum(overlap, 0.0)
    return 0.4 * closed * closed * np.sqrt(closed)


def stiffness(overlap: Any) -> Any:
    """Slope of the force: ``3/2 (overlap)+^0.5``."""
    return 1.5 * np.sqrt(np.maximum(overlap, 0.0))


def largest_overlap(total_energy: float) -> float:
    """Overlap at which one contact holds the whole energy: no run that conserves energy exceeds it."""
    return float((2.5 * total_energy) ** 0.4)


def bead_diameter(total_energy: float) -> float:
    """Diameter for LAMMPS: a power of two, so that touching is exact, and never small enough for second neighbours
    to meet or for one overlap to reach half of it.
    """
    two_contacts = 2.0 * largest_overlap(total_energy / 2.0)
    return power_of_two_at_least(max(4.0, 2.0 * largest_overlap(total_energy), two_contacts))


def pair_lines(diameter: float) -> list[str]:
    """The same law in LAMMPS, whose Hertz force is ``Kn * sqrt(diameter / 4) * overlap**1.5`` for equal beads."""
    return [
        f"pair_style gran/hertz/history {float(1.0 / np.sqrt(diameter / 4.0))!r} 0 0 0 0 0",
        "pair_coeff * *",
    ]
