"""How well a run conserves energy and momentum, from its trajectory (LAMMPS reports neither for these chains)."""

import numpy as np

from analysis import motion
from analysis.trajectory import Trajectory
from lammps_inputs.facts import Fact


class Conservation:
    """Largest deviation of energy and momentum from the kicks', over the frames seen so far.

    Attributes:
        energy_drift: relative to the energy of the kicks; NaN where not all beads are recorded, as in a window, and
            where the problem does not conserve it.
        momentum_drift: relative to the sum of the kicks' absolute momenta; NaN likewise.
        frames: number of frames seen.
        last_time: time of the last of them, in units of T.
        front: foremost bead (largest number) seen moving faster than 1e-3 of V.
    """

    def __init__(self) -> None:
        self.energy_drift = 0.0
        self.momentum_drift = 0.0
        self.frames = 0
        self.last_time = 0.0
        self.front = 0

    def add(self, block: Trajectory) -> None:
        """Take more frames into account."""
        problem = block.problem
        self.frames += block.frames
        self.last_time = float(block.time[-1])
        velocity = block.velocity
        passed = np.flatnonzero(np.any(np.abs(velocity) > 1e-3, axis=(0, 1)))
        if len(passed):
            self.front = max(self.front, int(block.beads[passed[-1]]))
        if not problem.whole:
            self.energy_drift = self.momentum_drift = float("nan")
            return
        # all beads, for the order in which a sum is taken must not depend on which of them move in this block
        energy = motion.energy(problem, block.displacement, velocity)
        momentum = motion.momentum(problem, velocity)
        for fact, drift in ((Fact.ENERGY, energy), (Fact.MOMENTUM, momentum)):
            if not problem.holds(fact):
                drift[:] = np.nan
        # np.maximum, unlike max(), lets NaN through
        self.energy_drift = float(np.maximum(self.energy_drift, np.max(np.abs(energy / problem.energy - 1.0))))
        self.momentum_drift = float(
            np.maximum(self.momentum_drift, np.max(np.abs(momentum - problem.momentum)) / problem.pushed)
        )
