"""What chains of unequal beads do to a pulse: the energy that it carries on, leaves behind in every cell, and splits.

The leading pulse is where the largest contact force of a chain is, which is defined whatever the beads' masses. It
carries the energy of the beads from a few behind it on; of that, what it loses from cell to cell is left behind. A cell
is the least piece of a pattern that repeats, one bead without one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis import motion
from analysis.mirror import direction_of, mirrored, mirrored_bead
from analysis.tracking.undisturbed import CLEAR
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

BEHIND = 4
"""Cells (of two beads at least) behind the largest force that count as the pulse's."""


@dataclass(frozen=True)
class Left:
    """What one chain's pulse left behind, in shares of the energy that was put in.

    Attributes:
        first, last: beads, as numbered in the scene, at which the pulse was compared; whole cells apart.
        carried: energy that it carried at the last of them.
        per_cell: lost from one cell to the next between them; NaN where it did not run a cell.
        rate: share of its own energy that it loses in a cell, of the exponential law fitted between them; NaN for
            fewer than three cells.
        deviation: largest relative difference of the energy that it carries from that law.
    """

    first: int
    last: int
    carried: float
    per_cell: float
    rate: float
    deviation: float


@dataclass(frozen=True)
class Split:
    """Where the energy of a chain is at the end, seen from one of its beads, in shares of the energy that was put in.

    Attributes:
        chain, bead: counted from 1.
        before, at, beyond: in beads of lower numbers, in this one, in those of higher numbers; the energy of a contact
            is half each bead's.
        incident: energy of the pulse as it came near.
        reflected: of that, what is on its side at the end; without what it had left behind there before.
    """

    chain: int
    bead: int
    before: float
    at: float
    beyond: float
    incident: float
    reflected: float


class CellEnergy:
    """Collects both from a run of all beads that is given block by block.

    Args:
        problem: what was run.
        period: beads of a cell.
        places: (chain, bead) from which the energy at the end is looked at.
    """

    def __init__(self, problem: Problem, period: int, places: tuple[tuple[int, int], ...] = ()) -> None:
        self.period = period
        self._problem = problem
        self._places = places
        self._carried, self._behind = np.full((2, problem.chains, problem.beads), np.nan)
        self._put_in = 0.0 if problem.loads else problem.energy
        self._front = np.zeros(problem.chains, dtype=np.int64)
        self._final: Floats | None = None
        self._end = np.zeros(problem.chains)

    def add(self, block: Trajectory) -> None:
        """Take the next frames, from the first of the run on."""
        if direction_of(self._problem) < 0:
            block = mirrored(block)
        energy = motion.bead_energy(block.problem, block.displacement, block.velocity)
        self._final = energy[-1]
        mass = block.problem.mass_of(slice(None), -1)
        self._end = np.maximum(self._end, np.max(0.5 * mass * block.velocity[..., -1] ** 2, axis=0))
        if self._problem.loads:
            total = motion.energy(block.problem, block.displacement, block.velocity)
            self._put_in = max(self._put_in, float(np.max(total)))
        ahead = np.cumsum(energy[..., ::-1], axis=-1)[..., ::-1]
        force = motion.contact_force(block.problem, motion.overlaps(block.problem, block.displacement))
        place = np.where(force.max(axis=-1) > 0.0, np.argmax(force, axis=-1), 0)
        reached = np.maximum.accumulate(np.vstack([self._front[np.newaxis], place]), axis=0)[1:]
        tail = np.maximum(reached - BEHIND * max(2, self.period), 0)
        carried = np.take_along_axis(ahead, tail[..., np.newaxis], axis=-1)[..., 0]
        frame, chain = np.nonzero(place == reached)
        # the last frame of each counts
        self._carried[chain, place[frame, chain]] = carried[frame, chain]
        self._behind[chain, place[frame, chain]] = (ahead[..., 0] - carried)[frame, chain]
        self._front = reached[-1]

    def left(self, chain: int) -> Left | None:
        """What the pulse of a chain, from 1, left behind on the second half of its way; None if it ran nowhere."""
        row = self._carried[chain - 1] / self._put_in
        seen = np.flatnonzero(np.isfinite(row[: self._problem.beads - CLEAR]))
        if len(seen) == 0 or seen[-1] == 0:
            return None
        last = int(seen[-1])
        like = seen[(last - seen) % self.period == 0]
        first = int(like[np.argmin(np.abs(like - last / 2.0))])
        cells = (last - first) // self.period
        per_cell = (row[first] - row[last]) / cells if cells else math.nan
        ends = (self._bead(first + 1), self._bead(last + 1))
        return Left(*ends, float(row[last]), float(per_cell), *self._law(row, like[like >= first]))

    def _law(self, row: Floats, like: NDArray[np.int64]) -> tuple[float, float]:
        """Rate of the exponential that the energy follows at beads that are whole cells apart, and how closely."""
        if len(like) < 3 or not np.all(row[like] > 0.0):
            return math.nan, math.nan
        cell = (like - like[0]) / self.period
        slope, start = np.polyfit(cell, np.log(row[like]), 1)
        return float(-np.expm1(slope)), float(np.max(np.abs(row[like] / np.exp(start + slope * cell) - 1.0)))

    def end(self, chain: int) -> float | None:
        """Largest kinetic energy that the last bead on the pulse's way has had; None if no pulse came there."""
        return float(self._end[chain - 1] / self._put_in) if self._front[chain - 1] >= self._problem.beads - 2 else None

    def splits(self) -> tuple[Split, ...]:
        """Where the energy is at the end of the frames so far, seen from each of the places."""
        if self._final is None:
            return ()
        return tuple(self._split(self._final / self._put_in, chain, bead) for chain, bead in self._places)

    def _split(self, share: Floats, chain: int, bead: int) -> Split:
        """From shares along the pulse's way, [chain, bead]."""
        here = self._bead(bead)
        sides = float(share[chain - 1, : here - 1].sum()), float(share[chain - 1, here:].sum())
        near = max(here - 1 - BEHIND * max(2, self.period), 0)
        incident, behind = (float(each[chain - 1, near] / self._put_in) for each in (self._carried, self._behind))
        forward = direction_of(self._problem) > 0
        at = float(share[chain - 1, here - 1])
        return Split(chain, bead, sides[not forward], at, sides[forward], incident, sides[0] - behind)

    def _bead(self, along: int) -> int:
        return along if direction_of(self._problem) > 0 else int(mirrored_bead(self._problem, along))
