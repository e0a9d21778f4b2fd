"""How well a run conserves energy and momentum, from its trajectory (LAMMPS reports neither for these chains)."""

from collections.abc import Callable

import numpy as np

from analysis import motion
from analysis.budget import Budget
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact


class Conservation:
    """Largest deviation of energy and momentum from what was put in, over the frames seen so far.

    That is the kicks', and what forces from outside have added until then.

    Attributes:
        energy_drift: relative to the most that was put in; what dashpots have taken counts as being there. NaN where
            not all beads are recorded, as in a window, and where nobody has counted what was exchanged.
        momentum_drift: relative to the sum of the absolute momenta of kicks and forces from outside, from when these
            are over; NaN likewise.
        frames: number of frames seen.
        last_time: time of the last of them, in units of T.
        budget: where the energy is; None where that is not known, and where none is exchanged.
        front: largest number of a bead seen moving faster than 1e-3 of V; None if none was.
    """

    def __init__(self, counted: Callable[[Trajectory], Trajectory] | None = None) -> None:
        """Begin; ``counted`` gives frames their ledger where those who computed them kept none."""
        self._counted = counted
        self.energy_drift = 0.0
        self.momentum_drift = 0.0
        self.frames = 0
        self.last_time = 0.0
        self.front: int | None = None
        self.budget: Budget | None = None
        self._put_in = self._missing = 0.0

    def add(self, block: Trajectory) -> None:
        """Take more frames into account."""
        problem = block.problem
        system = problem.system
        self.frames += block.frames
        self.last_time = float(block.time[-1])
        velocity = block.velocity
        passed = np.flatnonzero(np.any(np.abs(velocity) > 1e-3, axis=(0, 1)))
        if len(passed):
            self.front = max(self.front or 0, int(block.beads[passed[-1]]))
        if not problem.whole:
            self.energy_drift = self.momentum_drift = float("nan")
            return
        # all beads, for the order in which a sum is taken must not depend on which of them move in this block
        energy = motion.energy(system, block.displacement, velocity)
        momentum = motion.momentum(system, velocity)
        if not system.dampers and not system.holds(Fact.ENERGY):
            energy[:] = np.nan
        if physics.exchanges(system):
            self._balanced(block, energy)
        if not system.holds(Fact.MOMENTUM):
            momentum[:] = np.nan
        if physics.acted_on(system):
            self._pushed(block, momentum)
            return
        # np.maximum, unlike max(), lets NaN through
        if not physics.exchanges(system):
            self.energy_drift = float(
                np.maximum(self.energy_drift, np.max(np.abs(energy / physics.energy(system) - 1.0)))
            )
        self.momentum_drift = float(
            np.maximum(
                self.momentum_drift,
                np.max(np.abs(momentum - physics.momentum(system))) / physics.kick_momenta(system),
            )
        )

    def _balanced(self, block: Trajectory, energy: Floats) -> None:
        """With forces from outside or dashpots: energy is what was put in until then less what was lost."""
        if block.ledger is None and self._counted is not None:
            block = self._counted(block)
        if block.ledger is None:
            self.energy_drift = float("nan")
            return
        self.budget = self.budget or Budget(block.problem)
        put_in, lost = self.budget.add(block)
        self._put_in = max(self._put_in, float(np.max(np.abs(put_in))))
        self._missing = float(np.maximum(self._missing, np.max(np.abs(energy + lost - put_in))))
        self.energy_drift = self._missing / self._put_in if self._missing != 0.0 else 0.0

    def _pushed(self, block: Trajectory, momentum: Floats) -> None:
        """With forces from outside: momentum is that of the kicks and what they have given."""
        problem = block.problem
        system = problem.system
        if not system.holds(Fact.MOMENTUM):
            self.momentum_drift = float("nan")
            return
        size = physics.kick_momenta(system) + sum(load.law.total for load in system.loads)
        # in the velocity of a bead that is pushed LAMMPS has half a step of the mean of the force
        half = 0.5 * problem.timestep
        over = block.time > max(load.end for load in system.loads) + half * (1.0 + 1e-6)
        missing = np.abs(momentum - physics.momentum(system) - _given(problem, block.time))
        if physics.driven(system):
            halfway = 0.5 * (_given(problem, block.time - half) + _given(problem, block.time + half))
            missing = np.minimum(missing, np.abs(momentum - physics.momentum(system) - halfway))
            over = block.time > 0.0
        largest = float(np.max(missing[over], initial=0.0))
        self.momentum_drift = float(np.maximum(self.momentum_drift, largest / size))


def _given(problem: Problem, time: Floats) -> Floats:
    """Impulse by all forces from outside until a time."""
    return np.asarray(sum(load.impulse(time) for load in problem.system.loads))
