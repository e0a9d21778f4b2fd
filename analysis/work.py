"""The work that forces from outside do on the beads of a run, from its frames."""

from dataclasses import replace

import numpy as np

from analysis import hermite, motion
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import Problem

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)


class Work:
    """Adds up the integral of force times velocity over blocks of frames of all beads, from the first of the run on.

    Between two frames a bead's velocity is that which the force from outside alone gives it, exactly, and a polynomial
    through the rest and its first two derivatives. So no kink of the force is smoothed over.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._inside = replace(problem, loads=())
        self._done = np.zeros(len(problem.loads))
        self._last: Trajectory | None = None

    def add(self, block: Trajectory) -> Floats:
        """Work done until each of the next frames, [frame], in units of m V**2."""
        before = self._last
        self._last = block[-1:]
        both = block if before is None else joined([before, block])
        steps = np.zeros((both.frames, len(self._problem.loads)))
        for number in range(len(self._problem.loads)):
            steps[1:, number] = self._between(both, number)
        until = np.cumsum(steps, axis=0) + self._done
        self._done = until[-1]
        return np.asarray(until[both.frames - block.frames :].sum(axis=1))

    def _between(self, block: Trajectory, number: int) -> Floats:
        """Work of one load from each frame to the next."""
        load = self._problem.loads[number]
        time, work = block.time, np.zeros(block.frames - 1)
        acting = int(np.searchsorted(time[:-1], load.end))
        if acting == 0:
            return work
        same = [other for other in self._problem.loads if (other.chain, other.bead) == (load.chain, load.bead)]
        frame = np.arange(acting + 1)
        chain, bead = (np.full(frame.shape, place - 1) for place in (load.chain, load.bead))
        derivatives = motion.acceleration_and_rate(replace(block, problem=self._inside), frame, chain, bead)
        mass = self._problem.mass_of(load.chain - 1, load.bead - 1)
        alone = sum(other.impulse(time[frame]) for other in same) / mass
        data = np.stack([block.velocity[frame, chain, bead] - alone, *derivatives])
        rest = hermite.coefficients((0, 1), np.stack([data[:, :-1], data[:, 1:]]), block.spacing)

        kinks = np.array([kink for other in same for kink in other.law.kinks])
        inside = kinks[(kinks > time[0]) & (kinks < time[acting])]
        ends = np.unique(np.concatenate([time[: acting + 1], inside]))
        low, high = ends[:-1, np.newaxis], ends[1:, np.newaxis]
        t = 0.5 * (low + high) + 0.5 * (high - low) * _NODES
        interval = np.searchsorted(time[: acting + 1], low[:, 0], side="right") - 1
        s = (t - time[interval][:, np.newaxis]) / block.spacing
        velocity = hermite.value(rest[:, interval][..., np.newaxis], s) + sum(other.impulse(t) for other in same) / mass
        np.add.at(work, interval, np.sum(load.force(t) * velocity * _WEIGHTS * 0.5 * (high - low), axis=1))
        return work
