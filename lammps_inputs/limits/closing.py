"""Whether the kicks of a scene can ever close its gap: rows move by their springs until the first two beads meet.

With a gap no bead feels a contact before. The springs of a row push no bead back: what a kicked bead passes on moves
every bead of its row its way, at every time (integrals of Bessel functions J_2n from 0, which are positive, and their
images beyond the ends of the row). So a gap whose beads are all kicked apart stays open.
"""

import math
from collections import defaultdict
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray


def never_closes(chains: int, kappa: float, gap: float, kicks: Iterable[tuple[int, int, float]], beads: int) -> bool:
    """Whether it is certain that no two beads ever meet.

    Args:
        chains: number of chains.
        kappa: stiffness of the springs between neighbouring chains.
        gap: clear distance between the beads of a chain, in the units of the velocities and kappa (mass 1).
        kicks: (chain, bead, velocity), counted from 1.
        beads: beads of a chain.
    """
    closing: dict[int, NDArray[np.float64]] = defaultdict(lambda: np.zeros(chains))
    for chain, bead, velocity in kicks:
        closing[bead][chain - 1] += velocity
        closing[bead - 1][chain - 1] -= velocity
    return gap > 0.0 and all(_stays_open(speeds, kappa, gap) for bead, speeds in closing.items() if 1 <= bead < beads)


def lowest_modal_frequency(chains: int, kappa: float) -> float:
    """Angular frequency of the slowest mode in which a row of chains oscillates: sqrt(2 kappa) for two."""
    return 2.0 * math.sqrt(kappa) * math.sin(math.pi / (2.0 * chains))


def _stays_open(closing: NDArray[np.float64], kappa: float, gap: float) -> bool:
    """Whether a gap whose ends approach at these speeds [chain] is never closed: they part, or oscillate by less."""
    drift, chains = float(closing.mean()), len(closing)
    if np.all(closing <= 0.0):
        return True
    if kappa == 0.0 or chains == 1 or drift > 1e-12 * np.abs(closing).max():
        return False
    # no bead of a row oscillates by more than this share of the norm of the row
    share = math.sqrt((chains - 1) / chains) * float(np.linalg.norm(closing - drift))
    return share < gap * lowest_modal_frequency(chains, kappa)
