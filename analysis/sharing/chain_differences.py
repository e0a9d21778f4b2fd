"""Differences between the chains of a run of rigid and of one of elastic beads: impulses and shares of the energy.

A collision of rigid beads takes no time, so velocities at an instant differ by as much as beads move. What a contact
passes on, and which chain has the energy, can be compared.
"""

import math
from dataclasses import dataclass

import numpy as np

from analysis.compare.difference import Deviation, DeviationPlace, deviation_of
from analysis.sharing.energies import EnergyFlow
from analysis.sharing.impulses import ImpulseMeter, Impulses
from analysis.trajectory import Floats, Integers, Trajectory, along_the_way
from lammps_inputs import Problem

FREE_END = 5
"""Last beads on the pulse's way, which fly off; they are left out of chains of more than twice as many beads."""


@dataclass(frozen=True)
class ChainDifference:
    """Differences of one chain between a run of rigid and a run of elastic beads.

    Attributes:
        chain: its number, from 1.
        impulse: difference of the impulses that beads receive in their first contacts, each over the largest one of its
            row in the run of elastic beads; NaN where no row has one in both runs.
        agrees_until: bead up to which all of these differences are within the tolerance; None if the first is not.
        share: difference, over time, of the chain's share of the energy of all chains; NaN where not all beads are
            recorded.
    """

    chain: int
    impulse: Deviation
    agrees_until: int | None
    share: Deviation


class ChainMeter:
    """Compares chains of two runs that are given block by block, one of rigid and one of elastic beads.

    Args:
        problem: problem with the beads and times that both runs recorded.
        rigid_first: whether the first run is the one with rigid beads.
    """

    def __init__(self, problem: Problem, *, rigid_first: bool) -> None:
        self._elastic = 1 if rigid_first else 0
        self._problem = problem
        self._impulses = ImpulseMeter(problem)
        self._flows = (EnergyFlow(problem), EnergyFlow(problem)) if problem.rows.complete else None
        self.last_time = 0.0

    def add(self, first: Trajectory, second: Trajectory) -> None:
        """Take the next frames of both, at the same times."""
        blocks = first, second
        self._impulses.add(blocks[self._elastic])
        self.last_time = float(first.time[-1])
        if self._flows is not None:
            for flow, block in zip(self._flows, blocks, strict=True):
                flow.add(block)

    def result(self, rigid: Impulses, tolerance: float) -> tuple[dict[str, Deviation], tuple[ChainDifference, ...]]:
        """Deviations of all chains together, by ``impulse`` and ``share``, and each chain's.

        Args:
            rigid: impulses of the rigid beads until `last_time`.
            tolerance: largest difference of impulses that counts as agreement.

        Raises:
            ValueError: there was no frame.
        """
        bead, impulse, time = self._impulses_apart(rigid)
        share = self._shares_apart()
        deviations = {"impulse": _size(impulse), "share": _size(share)}
        if impulse.size:
            chain, row = (index.ravel() for index in np.indices(impulse.shape))
            deviations["impulse"] = deviation_of(
                impulse.ravel(),
                time.ravel(),
                tolerance,
                lambda k: DeviationPlace(int(chain[k]) + 1, int(bead[row[k]]), float(time.flat[k])),
            )
        if self._flows is None:
            del deviations["share"]
        chains = tuple(
            ChainDifference(
                chain=number + 1,
                impulse=_size(impulse[number]),
                agrees_until=_agrees_until(bead, impulse[number], tolerance),
                share=_size(share[:, number]),
            )
            for number in range(self._problem.chains)
        )
        return deviations, chains

    def _impulses_apart(self, rigid: Impulses) -> tuple[Integers, Floats, Floats]:
        """Rows in which a contact passed something on in both runs, in any chain, in the order of the pulse's way.

        Returns:
            receiving bead of each row, [row]; size of the difference, [chain, row]; time of the earlier of the two
            contacts, [chain, row], infinite where neither run has one.
        """
        problem, elastic = self._problem, self._impulses.result()
        bead, rows, rigid_rows = np.intersect1d(elastic.bead, rigid.bead, return_indices=True)
        bead = bead if problem.direction > 0 else bead - 1
        position = along_the_way(problem, bead)
        passed = np.any(elastic.first[:, rows] > 0.0, axis=0) & np.any(rigid.first[:, rigid_rows] > 0.0, axis=0)
        if problem.beads > 2 * FREE_END:
            passed &= position <= problem.beads - FREE_END
        order = np.argsort(position)
        order = order[passed[order]]
        bead, rows, rigid_rows = bead[order], rows[order], rigid_rows[order]
        size = np.abs(rigid.first[:, rigid_rows] - elastic.first[:, rows]) / elastic.first[:, rows].max(axis=0)
        time = np.fmin(rigid.time[:, rigid_rows], elastic.time[:, rows])
        return bead, size, np.where(np.isnan(time), np.inf, time)

    def _shares_apart(self) -> Floats:
        """Size of the difference of each chain's share of the energy, [instant, chain]; no instant if unknown."""
        if self._flows is None:
            return np.zeros((0, self._problem.chains))
        first, second = (flow.result().share for flow in self._flows)
        return np.asarray(np.abs(first - second))


def _size(difference: Floats) -> Deviation:
    """Largest and root-mean-square size of differences; NaN where there is none."""
    if not difference.size:
        return Deviation(math.nan, math.nan)
    return Deviation(float(difference.max()), float(np.sqrt(np.mean(difference**2))))


def _agrees_until(bead: Integers, difference: Floats, tolerance: float) -> int | None:
    """Bead of the last row before the first one whose difference exceeds the tolerance; None where there is none."""
    agreeing = np.logical_and.accumulate(difference <= tolerance)
    return int(bead[agreeing][-1]) if agreeing.any() else None
