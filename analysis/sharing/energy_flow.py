"""Where the energy is over time: the share of each chain, its centre along the chain, and how far it is spread.

For problems in which no pulse stays together, such as chains on a foundation; makes sense of any.
"""

import numpy as np

from analysis import motion
from analysis.budget import energy_input
from analysis.quantity import declare, result
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

MOST_INSTANTS = 500

LEAST = 1e-9
"""Share of a chain below which it has no centre."""


NO_CENTRE = "the chain has no energy"


@result
class Flow:
    """Energy at some instants."""

    time: Floats = declare("time of some frames", "time", symbol="t")
    share: Floats = declare(
        "energy of each chain (kinetic, contacts, ground) over that of all chains, [instant][chain]"
    )
    between: Floats = declare(
        "energy in the springs between chains over the energy input until then (kicks, work of pushes and drives)",
        undefined="the input is not positive, or that work is not known",
    )
    centre: Floats = declare("mean bead number of the chain's energy, [instant][chain]", "beads", NO_CENTRE)
    spread: Floats = declare("standard deviation of the bead number of the chain's energy", "beads", NO_CENTRE)

    def extremes(self, chain: int) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and largest share of a chain (from 0) after the start, each with its time; the start if alone."""
        later = slice(1, None) if len(self.time) > 1 else slice(None)
        share, time = self.share[later, chain], self.time[later]
        least, most = int(np.argmin(share)), int(np.argmax(share))
        return (float(share[least]), float(time[least])), (float(share[most]), float(time[most]))


class EnergyFlow:
    """Collects a `Flow` from a run of all beads that is given block by block."""

    def __init__(self, problem: Problem) -> None:
        self._stride = -(-(problem.frames + 1) // MOST_INSTANTS)
        self._seen = 0
        self._found: list[tuple[Floats, ...]] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        chosen = slice(-self._seen % self._stride, None, self._stride)
        self._seen += block.frames
        x, v = block.displacement[chosen], block.velocity[chosen]
        energy = motion.bead_energy(block.problem.system, x, v, block.first)
        of_chain = energy.sum(axis=-1, keepdims=True)
        total = of_chain.sum(axis=-2, keepdims=True)
        share = (of_chain / np.where(total > 0.0, total, np.inf))[..., 0]  # a drive may begin with none
        between = np.zeros(len(x))
        for link in block.problem.system.across:
            between += np.sum(link.energy(x, block.first), axis=(-2, -1))
        put_in = energy_input(block)[chosen]
        between /= np.where(put_in > 0.0, put_in, np.nan)
        with np.errstate(invalid="ignore", divide="ignore"):
            weight = np.where(share > LEAST, 1.0, np.nan)[..., np.newaxis] * energy / of_chain
        centre = np.sum(weight * block.beads, axis=-1)
        spread = np.sqrt(np.sum(weight * (block.beads - centre[..., np.newaxis]) ** 2, axis=-1))
        self._found.append((block.time[chosen], share, between, centre, spread))

    def result(self) -> Flow:
        """Of the frames so far.

        Raises:
            ValueError: there was none.
        """
        if not self._found:
            raise ValueError("no frames to measure")
        return Flow(*(np.concatenate(part) for part in zip(*self._found, strict=True)))
