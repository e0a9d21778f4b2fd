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


def never_closes(
    chains: int,
    kappa: float,
    gap: float | NDArray[np.float64],
    kicks: Iterable[tuple[int, int, float]],
    beads: int,
) -> bool:
    """Whether it is certain that no two beads ever meet.

    Args:
        chains: number of chains.
        kappa: stiffness of the springs between neighbouring chains.
        gap: clear distance between the beads of a chain, in the units of the velocities and kappa (mass 1): a number,
            or [chain, contact].
        kicks: (chain, bead, velocity), counted from 1.
        beads: beads of a chain.
    """
    if not np.any(gap):
        return False
    closing: dict[int, NDArray[np.float64]] = defaultdict(lambda: np.zeros(chains))
    for chain, bead, velocity in kicks:
        closing[bead][chain - 1] += velocity
        closing[bead - 1][chain - 1] -= velocity
    least = np.min(np.broadcast_to(gap, (chains, beads - 1)), axis=0).tolist()
    between = ((speeds, least[bead - 1]) for bead, speeds in closing.items() if 1 <= bead < beads)
    return max(least) > 0.0 and all(each > 0.0 and _stays_open(speeds, kappa, each) for speeds, each in between)


def lowest_modal_frequency(chains: int, kappa: float) -> float:
    """Angular frequency of the slowest mode in which a row of chains oscillates: sqrt(2 kappa) for two."""
    return 2.0 * math.sqrt(kappa) * math.sin(math.pi / (2.0 * chains))


THETA_OF_EQ_5 = (math.pi + 2.0) / 4.0
"""theta at which bead 1 of chain 1 meets bead 2 at omega t = pi / 2, with 1/2 V: 1.2854.

Examples:
    >>> system = granchain.load("two-chains-gapped").problem().system
    >>> theta = np.sqrt(2.0 * physics.kappa(system)) * physics.gap(system)
    >>> bool(abs(theta - THETA_OF_EQ_5) < 1e-6)
    True
"""


def theta(kappa: float, gap: float) -> float:
    """The one number of rigid dynamics: omega D / V, with omega = sqrt(2 kappa) of two chains and V = 1.

    With more chains it is the same measure of the coupling, no longer a frequency of the row.
    """
    return math.sqrt(2.0 * kappa) * gap


def gap_of_eq_5(kappa: float) -> float:
    """D = (pi + 2) / (4 omega), eq. 5, in units of L for V = 1 and N = 2.

    Raises:
        ValueError: without coupling no gap fulfils it.
    """
    if not kappa > 0.0:
        raise ValueError("coupling: eq. 5 gives a gap only with springs (kappa > 0)")
    return THETA_OF_EQ_5 / math.sqrt(2.0 * kappa)


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
