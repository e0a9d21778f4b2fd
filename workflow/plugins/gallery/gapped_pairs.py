"""Pulses in gapped chains of Hertz beads: the problems that the entries on the paper's open question run, and measures.

A relative mode of row n is measured by the impulses that its beads receive from those before; dimensionless.
"""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, Trajectory, engine, impulses, library
from workflow.plugins.gallery import row_map

AGREE = 0.01
"""Relative difference of the chains' impulses, (largest - smallest) / mean, up to which they count as equal."""

MOST_ROWS = 1000
"""Rows after which agreement is no longer waited for."""

LASTING = 5
"""Rows at the end in which impulses must agree at the least."""

SLOWEST = 0.03
"""Speed of the slowest pulse that is waited for, in units of V."""


def gapped(theta: float, kappa: float, rows: int, kicks: Sequence[float], **keys: Any) -> dict[str, Any]:
    """Plain data of a scene of gapped chains, without its name, whose first beads are kicked.

    Args:
        theta: omega D / V with omega = sqrt(2 kappa), also for more chains.
        kappa: stiffness of the springs.
        rows: number of rows in which impulses are received; six more are beyond.
        kicks: velocities of the first beads, [chain]; the largest is V.
        keys: further keys of the scene.
    """
    gap, share = theta / math.sqrt(2.0 * kappa), min(kicks) or SLOWEST
    duration = (rows + 1) * (gap / share + 3.0)
    kicked = [{"chain": chain, "bead": 1, "velocity": v} for chain, v in enumerate(kicks, 1) if v]
    every = keys.pop("every", 0.25)
    return {
        "chains": len(kicks),
        "beads": rows + 6,
        "coupling": {"stiffness": kappa},
        "gap": gap,
        "kick": kicked,
        "duration": every * math.ceil(duration / every),
        "output": {"every": every},
        **keys,
    }


def problem_of(plain: Mapping[str, Any]) -> Problem:
    """The problem of a scene without its name."""
    return library.from_plain({"name": "gapped", **plain}, "gapped").problem()


def impulses_until(problem: Problem, row: int) -> impulses.Impulses:
    """Impulses of a problem by the reference, until the pulse has passed a row in all chains, or to the end."""

    def passing(blocks: Iterator[Trajectory]) -> Iterator[Trajectory]:
        for block in blocks:
            yield block
            if np.all(block.velocity[-1, :, row + 1] != 0.0):
                return

    return impulses.measure(problem, passing(iter(engine.blocks(problem))))


@dataclass(frozen=True)
class Shared:
    """How a pulse that starts in the first of gapped chains is shared.

    Attributes:
        theta: omega D / V with omega = sqrt(2 kappa).
        kappa: stiffness of the springs.
        chains: number of chains.
        rows: rows that were computed.
        difference: of the impulses of a row, (largest - smallest) / mean, [row].
        mode: of two chains, (I_1 - I_2) / (I_1 + I_2), [row]; of more, the projection on the slowest mode.
        amplitude: mean impulse of the chains in the last rows, in units of m V; NaN if they do not agree.
    """

    theta: float
    kappa: float
    chains: int
    rows: int
    difference: Floats
    mode: Floats
    amplitude: float

    def within(self, tolerance: float) -> int | None:
        """Row from which on impulses agree to a tolerance; None if not for the last rows."""
        apart = np.flatnonzero(~(self.difference <= tolerance))
        first = int(apart[-1]) + 1 if len(apart) else 0
        return first + 2 if first <= len(self.difference) - LASTING else None  # row 2 is the first that receives

    @property
    def energy(self) -> float:
        """Share of the energy input that the pulses have when the rows agree: that of beads in free flight."""
        return self.chains * self.amplitude**2

    @property
    def at_speed(self) -> tuple[float, float]:
        """``theta`` and ``stiffness`` of `row_map` for the slowest mode, with the last speed."""
        stiffness = slowest(self.chains) * self.kappa * self.amplitude**-0.4
        return self.theta * math.sqrt(slowest(self.chains) / 2.0) / self.amplitude, stiffness

    @property
    def recurrence(self) -> row_map.Recurrence | None:
        """Map of the mode in the rows where it is small."""
        return row_map.recurrence(self.mode[10:])


def slowest(chains: int) -> float:
    """Least eigenvalue above 0 of an open row of chains."""
    return 2.0 - 2.0 * math.cos(math.pi / chains)


@cache
def shared(theta: float, kappa: float, chains: int = 2, most_rows: int = MOST_ROWS) -> Shared:
    """Compute how a pulse is shared, in more rows than it takes to agree to 1 %, or in ``most_rows``."""
    rows = min(most_rows, math.ceil(30 + 16.0 / (kappa * slowest(chains))))
    while True:
        result = _in_rows(theta, kappa, chains, rows)
        agree = result.within(AGREE)
        if rows >= most_rows or (agree is not None and agree < 0.85 * rows):
            return result
        rows = min(most_rows, 2 * rows)


def _in_rows(theta: float, kappa: float, chains: int, rows: int) -> Shared:
    problem = problem_of(gapped(theta, kappa, rows, [1.0, *[0.0] * (chains - 1)]))
    received = impulses_until(problem, rows)
    first = received.first[:, : rows - 1]
    difference = impulses.relative_difference(first)
    profile = np.cos(math.pi * (np.arange(chains) + 0.5) / chains)
    with np.errstate(invalid="ignore", divide="ignore"):
        mode = profile @ first / first.sum(axis=0) / profile[0]
    last = first[:, -LASTING:]
    agrees = bool(np.all(difference[-LASTING:] <= AGREE))  # NaN where the pulse has not arrived
    return Shared(theta, kappa, chains, rows, difference, mode, float(last.mean()) if agrees else math.nan)


@dataclass(frozen=True)
class MeasuredMap:
    """Map of the relative mode of a nearly synchronised pulse in two chains.

    Attributes:
        theta, stiffness: of `row_map`, with the speed in the last row.
        recurrence: what was measured.
    """

    theta: float
    stiffness: float
    recurrence: row_map.Recurrence

    @property
    def predicted(self) -> Floats:
        """Map that `row_map` predicts, [2, 2]."""
        return row_map.row_map(self.theta, self.stiffness)


def measured(theta: float, kappa: float, received: impulses.Impulses, rows: int) -> MeasuredMap:
    """The map in the rows of a run of two chains that were both kicked.

    Args:
        theta: omega D / V.
        kappa: stiffness of the springs.
        received: impulses of the run.
        rows: that were to receive impulses.
    """
    first = received.first[:, : rows - 1]
    speed = float(first[:, -1].mean())
    recurrence = row_map.recurrence((first[0] - first[1])[1:] / first.sum(axis=0)[1:])
    assert recurrence is not None, "the difference at the start is within the sizes that count"
    return MeasuredMap(theta / speed, 2.0 * kappa * speed**-0.4, recurrence)


def table(names: Sequence[str], rows: Sequence[Sequence[float | int | str | None]]) -> str:
    """Text of a CSV file; an empty cell is undefined."""
    lines = [",".join("" if value is None or value != value else str(value) for value in row) for row in rows]
    return "\n".join(itertools.chain([",".join(names)], lines)) + "\n"
