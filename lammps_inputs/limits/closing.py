"""Whether the kicks of a scene can ever close its gap: rows move by their springs until the first two beads meet.

With a gap no bead feels a contact before. Row i has the mean velocity u_i of its kicks, and oscillates about it by its
modes (`workflow.engines.collisions.modes` has them too). The gap before row i + 1 closes by d(t) = x_i - x_{i+1}.
"""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_WORK = 10**7
"""Numbers to compute at most; a scene that needs more to be proven pointless passes for a good one."""


def never_closes(chains: int, kappa: float, gap: float, kicks: Iterable[tuple[int, int, float]], beads: int) -> bool:
    """Whether it is certain that no two beads ever meet.

    Args:
        chains: number of chains.
        kappa: stiffness of the springs between neighbouring chains.
        gap: clear distance between the beads of a chain, in the units of the velocities and kappa (mass 1).
        kicks: (chain, bead, velocity), counted from 1.
        beads: beads of a chain.
    """
    if gap <= 0.0:
        return False
    rows: dict[int, dict[int, float]] = {}
    for chain, bead, velocity in kicks:
        rows.setdefault(bead, {})[chain] = velocity
    behind = {bead for row in rows for bead in (row - 1, row) if 1 <= bead < beads}
    if kappa == 0.0 or chains == 1:
        at_rest: dict[int, float] = {}
        return not any(
            rows.get(bead, at_rest).get(chain, 0.0) > rows.get(bead + 1, at_rest).get(chain, 0.0)
            for bead in behind
            for chain in {*rows.get(bead, at_rest), *rows.get(bead + 1, at_rest)}
        )
    relative = []
    for bead in sorted(behind):
        closing = np.zeros(chains)
        for chain, velocity in rows.get(bead, {}).items():
            closing[chain - 1] += velocity
        for chain, velocity in rows.get(bead + 1, {}).items():
            closing[chain - 1] -= velocity
        if closing.sum() > 1e-12 * np.abs(closing).max():
            return False  # the rows drift together
        relative.append(closing)
    return all(_stays_open(closing, kappa, gap) for closing in relative)


def lowest_modal_frequency(chains: int, kappa: float) -> float:
    """Angular frequency of the slowest mode in which a row of chains oscillates: sqrt(2 kappa) for two."""
    return 2.0 * math.sqrt(kappa) * math.sin(math.pi / (2.0 * chains))


def _stays_open(closing: Floats, kappa: float, gap: float) -> bool:
    """Whether a row whose beads set out with these velocities [chain] provably never advances by the gap anywhere."""
    chains = len(closing)
    drift = min(0.0, float(closing.mean()))
    deviation = closing - closing.mean()
    # no bead of a row oscillates by more than this share of the norm of the row
    share = math.sqrt((chains - 1) / chains) * float(np.linalg.norm(deviation))
    slowest = lowest_modal_frequency(chains, kappa)
    rounding = 1e-12 * float(np.abs(closing).max())
    if share / slowest < gap or drift + share <= rounding:
        return True
    if drift > -rounding or chains**2 > MOST_WORK:
        return False
    # the farthest that the drift can be made up for, in steps between which no oscillation grows by half the gap
    end = (share / slowest - gap) / -drift
    fastest = 2.0 * math.sqrt(kappa)
    steps = end * math.sqrt(share * fastest / gap) / 2.0
    if not steps * chains**2 <= MOST_WORK:  # also without end, where the gap is next to nothing
        return False
    mode = np.arange(1, chains)
    shape = np.sqrt(2.0 / chains) * np.cos(math.pi / chains * np.outer(mode, np.arange(chains) + 0.5))
    omega = 2.0 * math.sqrt(kappa) * np.sin(math.pi / (2.0 * chains) * mode)
    time = np.linspace(0.0, end, math.ceil(steps) + 2)[:, np.newaxis]
    advance = drift * time + (np.sin(omega * time) * (shape @ deviation) / omega) @ shape
    return bool(advance.max() < 0.5 * gap)
