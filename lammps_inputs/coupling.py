"""Linear springs between the beads of one row in neighbouring chains (an open row of chains, 1 - 2 - ... - N).

The physics stands beside the LAMMPS lines that mean the same.
"""

import math
from typing import Any


def energy(relative: Any, stiffness: float) -> Any:
    """Energy of a spring whose ends are displaced by ``relative`` along the chain: ``1/2 kappa relative**2``."""
    return 0.5 * stiffness * relative * relative


def largest_eigenvalue(chains: int) -> float:
    """Largest eigenvalue of the springs' graph Laplacian: 2 for two chains, below 4 for any open row."""
    return 2.0 - 2.0 * math.cos(math.pi * (chains - 1) / chains)


def slowest_swing(chains: int, kappa: float) -> float:
    """Angular frequency of the slowest mode in which a row of chains swings: sqrt(2 kappa) for two."""
    return 2.0 * math.sqrt(kappa) * math.sin(math.pi / (2.0 * chains))


def bond_lines() -> list[str]:
    """The same springs in LAMMPS, whose harmonic bond energy is ``K (r - r0)**2``, for a deck variable ``kappa``.

    With r0 = 0 the bond is linear in each coordinate, so the force along the chain is exactly ``-kappa`` times the
    relative displacement at any lateral distance. (With r0 = the distance it would be cubic.)
    """
    return [
        "bond_style harmonic",
        "bond_coeff 1 $(v_kappa/2:%.17g) 0",
    ]
