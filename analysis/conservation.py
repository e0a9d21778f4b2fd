"""How well a run conserves energy and momentum, from its trajectory (LAMMPS reports neither for these chains)."""

from dataclasses import replace

import numpy as np

from analysis import motion
from analysis.trajectory import Floats, Trajectory
from analysis.work import Work
from lammps_inputs.facts import Fact


class Conservation:
    """Largest deviation of energy and momentum from what was put in, over the frames seen so far.

    That is the kicks', and what forces from outside have added until then.

    Attributes:
        energy_drift: relative to the most that was put in; NaN where not all beads are recorded, as in a window, and
            where the problem does not conserve it.
        momentum_drift: relative to the sum of the absolute momenta of kicks and forces from outside, from when these
            are over; NaN likewise.
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
        self._work: Work | None = None
        self._put_in = self._missing = 0.0

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
        if problem.loads:
            self._budget(block, energy, momentum)
            return
        # np.maximum, unlike max(), lets NaN through
        self.energy_drift = float(np.maximum(self.energy_drift, np.max(np.abs(energy / problem.energy - 1.0))))
        self.momentum_drift = float(
            np.maximum(self.momentum_drift, np.max(np.abs(momentum - problem.momentum)) / problem.pushed)
        )

    def _budget(self, block: Trajectory, energy: Floats, momentum: Floats) -> None:
        """With forces from outside: energy is that of the kicks and the work done, momentum likewise."""
        problem = block.problem
        self._work = self._work or Work(problem)
        put_in = replace(problem, loads=()).energy + self._work.add(block)
        self._put_in = max(self._put_in, float(np.max(np.abs(put_in))))
        self._missing = float(np.maximum(self._missing, np.max(np.abs(energy - put_in))))
        self.energy_drift = self._missing / self._put_in if self._missing > 0.0 else self._missing
        given = sum(load.impulse(block.time) for load in problem.loads)
        size = problem.pushed + sum(load.law.total for load in problem.loads)
        # in the velocity of a bead that is pushed LAMMPS has half a step of the mean of the force
        over = block.time > max(load.end for load in problem.loads) + 0.5 * problem.timestep * (1.0 + 1e-6)
        missing = float(np.max(np.abs(momentum - problem.momentum - given)[over], initial=0.0))
        self.momentum_drift = float(np.maximum(self.momentum_drift, missing / size))
