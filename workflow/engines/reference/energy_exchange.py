"""What is exchanged between frames that somebody else has computed: each is followed to the next by the reference.

Independent of files. Frames are of all beads, at any distance in time.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from analysis.conservation import FrameAccountant
from analysis.trajectory import EXCHANGES, Floats, Trajectory, joined
from lammps_inputs import Problem, physics
from workflow.engines.reference import engine
from workflow.engines.reference.schemes import BLANES_MOAN


@dataclass
class Accountant(FrameAccountant):
    """Gives the frames of a run their exchange.

    Args:
        problem: the run's problem.
        steps_per_frame: steps of the reference from frame to frame, an even number; by default as many as
            `engine.default_steps_per_frame` says. With those of a run by the reference the exchange is the run's own.
    """

    problem: Problem
    steps_per_frame: int | None = None
    uncertainty: float = field(init=False, default=0.0)
    """Largest change of the remaining energy by half as many steps, in units of m V**2, over the frames so far."""

    def counted(self, blocks: Iterable[Trajectory]) -> Iterator[Trajectory]:
        """Consecutive frames of a run, from its first on, with their exchange.

        Frames that have it already, do not hold all beads, or exchange nothing stay as they are.
        """
        self.uncertainty = 0.0
        if not (self.problem.rows.complete and physics.exchanges(self.problem.system)):
            yield from blocks
            return
        steps = self.steps_per_frame or engine.default_steps_per_frame(self.problem)
        followers = [_Follower(self.problem, count) for count in (steps, max(1, steps // 2))]
        before: list[Trajectory] = []
        for block in blocks:
            if block.exchange is not None:
                yield block
                continue
            both = joined([*before, block])
            with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
                fine, coarse = (follower.along(both)[both.frames - block.frames :] for follower in followers)
                apart = (fine - coarse) @ _LEFT
            self.uncertainty = float(np.maximum(self.uncertainty, np.max(np.abs(apart))))
            before = [block[-1:]]
            yield replace(block, exchange=fine)


_LEFT = np.where(np.array(EXCHANGES) == "energy_input", 1.0, -1.0)


class _Follower:
    """Follows frames with a number of steps from each to the next."""

    def __init__(self, problem: Problem, steps: int) -> None:
        system = problem.system
        self._problem = problem
        self._steps = steps
        self._state = engine.make_state(problem, None)
        self._until = np.zeros((1, len(EXCHANGES)))
        self._more = 0.0
        self._over = np.inf
        if not system.dampers and not physics.driven(system):
            self._over = max(load.end for load in system.loads)

    def along(self, block: Trajectory) -> Floats:
        """Exchange [frame, entry] of frames of which the first was the last one before, or the start."""
        problem, state = self._problem, self._state
        exchange = np.repeat(self._until, block.frames, axis=0)
        x, v = block.atoms
        w = engine.velocity_of_state(problem.system, x, v)
        pushed = np.array(sorted({load.bead for load in problem.system.loads}), dtype=np.int64)
        end = state.frame_arrays(1, problem.chains, len(pushed))
        for frame in range(1, block.frames):
            if block.time[frame - 1] < self._over:
                state.restart(block, frame - 1, x[frame - 1], w[frame - 1])
                number = round(float(block.time[frame - 1]) / problem.every) * self._steps
                frames = end._replace(exchange=exchange[frame : frame + 1])
                state.advance(BLANES_MOAN, problem.every / self._steps, number, self._steps, pushed, frames)
                self._more += self._on_the_way(block, frame, block.velocity[frame][:, pushed - 1] - end.v[0], pushed)
                exchange[frame, -1] += self._more
            else:
                exchange[frame] = exchange[frame - 1]
        self._until = exchange[-1:].copy()
        exchange[:, -1] += engine.brought_up(problem, block.time)
        return exchange

    def _on_the_way(self, block: Trajectory, frame: int, apart: Floats, pushed: NDArray[np.int64]) -> float:
        """Work of loads, in m V**2, by the velocity ``apart`` [chain, place] that beads have beyond the reference's."""
        before, after = block.time[frame - 1], block.time[frame]
        return sum(
            0.5 * float(load.impulse(after) - load.impulse(before)) * float(apart[load.chain - 1, place])
            for load in self._problem.system.loads
            for place in np.flatnonzero(pushed == load.bead)
        )
