"""Differences between the chains of a run of rigid and of one of elastic beads: impulses and shares of the energy.

A collision of rigid beads takes no time, so velocities at an instant differ by as much as beads move. What a contact
passes on, and which chain has the energy, can be compared.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from analysis.compare.difference import Deviation, DeviationPlace, deviation_of
from analysis.meters import Part
from analysis.sharing.energies import FlowMeter
from analysis.sharing.impulses import ImpulseMeter, Impulses
from analysis.trajectory import Floats, Integers, along_the_way
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


class _OfChains(NamedTuple):
    """What a comparison of chains takes from a part of each of two runs.

    Attributes:
        pushes: what the impulses of the elastic beads follow from.
        flows: what the shares of the energy in both runs follow from; None where not all beads are recorded.
    """

    pushes: Any
    flows: tuple[Any, Any] | None


@dataclass(frozen=True)
class ChainMeter:
    """Differences between the chains of two runs, one of rigid and one of elastic beads, by pairs of parts.

    Attributes:
        problem: problem with the beads and times that both runs recorded.
        rigid_first: whether the first run is the one with rigid beads.
    """

    problem: Problem
    rigid_first: bool

    def of_parts(self, first: Part, second: Part) -> _OfChains:
        """What the differences take from a part of each run, at the same times."""
        pushes = ImpulseMeter(self.problem).of_part(second if self.rigid_first else first)
        if not self.problem.rows.complete:
            return _OfChains(pushes, None)
        flow = FlowMeter(self.problem)
        return _OfChains(pushes, (flow.of_part(first), flow.of_part(second)))

    def result(
        self, pieces: list[_OfChains], rigid: Impulses, tolerance: float
    ) -> tuple[dict[str, Deviation], tuple[ChainDifference, ...]]:
        """Deviations of all chains together, by ``impulse`` and ``share``, and each chain's.

        Args:
            pieces: from all pairs of parts, in order.
            rigid: impulses of the rigid beads until the last frame.
            tolerance: largest difference of impulses that counts as agreement.
        """
        elastic = ImpulseMeter(self.problem).result([piece.pushes for piece in pieces])
        bead, impulse, time = self._impulses_apart(elastic, rigid)
        share = self._shares_apart([piece.flows for piece in pieces if piece.flows is not None])
        deviations = {"impulse": _size(impulse), "share": _size(share)}
        if impulse.size:
            chain, row = (index.ravel() for index in np.indices(impulse.shape))
            deviations["impulse"] = deviation_of(
                impulse.ravel(),
                time.ravel(),
                tolerance,
                lambda k: DeviationPlace(int(chain[k]) + 1, int(bead[row[k]]), float(time.flat[k])),
            )
        if not self.problem.rows.complete:
            del deviations["share"]
        chains = tuple(
            ChainDifference(
                chain=number + 1,
                impulse=_size(impulse[number]),
                agrees_until=_agrees_until(bead, impulse[number], tolerance),
                share=_size(share[:, number]),
            )
            for number in range(self.problem.chains)
        )
        return deviations, chains

    def _impulses_apart(self, elastic: Impulses, rigid: Impulses) -> tuple[Integers, Floats, Floats]:
        """Rows in which a contact passed something on in both runs, in any chain, in the order of the pulse's way.

        Returns:
            receiving bead of each row, [row]; size of the difference, [chain, row]; time of the earlier of the two
            contacts, [chain, row], infinite where neither run has one.
        """
        problem = self.problem
        bead, rows, rigid_rows = np.intersect1d(elastic.bead, rigid.bead, return_indices=True)
        bead = elastic.pushed(problem.direction)[rows]
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

    def _shares_apart(self, flows: list[tuple[Any, Any]]) -> Floats:
        """Size of the difference of each chain's share of the energy, [instant, chain]; no instant if unknown."""
        if not flows:
            return np.zeros((0, self.problem.chains))
        first, second = (FlowMeter(self.problem).result(list(of_run)).share for of_run in zip(*flows, strict=True))
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
