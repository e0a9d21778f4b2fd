"""The statements of section 3 of the paper on beads with gaps, as numbers.

Two chains throughout, bead 1 of chain 1 kicked with V = 1. Two models of the same gap: rigid beads (engine
`collisions`) depend on theta = omega D / V alone, omega = sqrt(2 kappa); Hertz beads (eq. 2, the reference) also on
kappa, through the ratio of the duration of a contact to the period of the springs.

The impulse of row n is that which bead n receives from bead n - 1; see `analysis.sharing.impulses`.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.figures.engines import Curve
from analysis.files.events import Events
from analysis.sharing.impulses import ImpulseMeter, Impulses, from_events, relative_difference
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, System, physics
from lammps_inputs.ingredients import coupled_chains
from lammps_inputs.units import DIMENSIONLESS
from workflow.engines import collisions
from workflow.engines.reference import engine as reference

AGREE = 0.01
"""Relative difference of the chains' impulses up to which they count as equal (the paper: "identical")."""

SLOWEST = 0.25
"""Speed of the slowest pulse that a run of Hertz beads waits for, in units of V: below equal sharing (1/2)."""

LAST_STRAGGLERS = 0.01
"""The same for rigid beads, some of which first collide with beads behind the pulse."""


def gap_at(theta: float, kappa: float) -> float:
    """D = theta / sqrt(2 kappa), in units of L."""
    return theta / math.sqrt(2.0 * kappa)


def problem_at(theta: float, kappa: float, row: int, *, every: float = 0.25, slowest: float = SLOWEST) -> Problem:
    """Two chains in which the pulse passes a row, with ten rows more and the time for a few periods.

    Args:
        theta: omega D / V.
        kappa: stiffness of the springs.
        row: number of the last bead of interest.
        every: time between frames, in units of T.
        slowest: speed of the slowest pulse to wait for.
    """
    gap, omega = gap_at(theta, kappa), math.sqrt(2.0 * kappa)
    duration = row * (gap / slowest + 3.0) + 6.0 * math.pi / omega
    frames = math.ceil(duration / every)
    return Problem(
        name="gapped",
        system=System(chains=2, beads=row + 10, kicks=((1, 1, 1.0),), links=coupled_chains(2, kappa, gap)),
        timestep=every,
        steps_per_frame=1,
        frames=frames,
        recorded=None,
        scale=DIMENSIONLESS,
    )


def rigid_problem(theta: float, row: int) -> Problem:
    """Rigid beads at some theta until all collisions have happened; kappa = 1/2, so omega = 1 and D = theta."""
    return problem_at(theta, 0.5, row, slowest=LAST_STRAGGLERS)


def rigid_impulses(problem: Problem) -> Impulses:
    """Impulses of a problem's rigid beads."""
    return _impulses(problem, collisions.run(problem))


def _impulses(problem: Problem, found: collisions.CollisionRun) -> Impulses:
    return from_events(problem, Events(found.time, found.chain, found.row, found.striker, found.target))


def hertz_impulses(problem: Problem) -> Impulses:
    """Impulses of a problem's Hertz beads, by the reference, frame by frame."""
    meter = ImpulseMeter(problem)
    for block in reference.blocks(problem):
        meter.add(block)
    return meter.result()


# --- eq. 5 and the paper's Figs 8 and 9 -------------------------------------------------------------------------------


def curves(problem: Problem, rows: Sequence[int] = (5, 25)) -> list[Curve]:
    """Velocities over time and first impulses of rows of rigid beads (exact) and of Hertz beads (reference)."""
    place = [int(np.flatnonzero(problem.recorded_beads == row)[0]) for row in rows]
    rigid = collisions.run(problem)
    models: dict[str, tuple[Iterable[Trajectory], Impulses]] = {
        "rigid": (collisions.blocks(rigid), _impulses(problem, rigid)),
        "Hertz": (reference.blocks(problem), hertz_impulses(problem)),
    }
    found = []
    for name, (blocks, impulses) in models.items():
        parts = [(block.time, block.velocity[:, :, place].copy()) for block in blocks]
        time, velocity = (np.concatenate(column) for column in zip(*parts, strict=True))
        found.append(Curve(name, time, velocity, impulses.bead, impulses.first))
    return found


@dataclass(frozen=True)
class FirstRow:
    """The first row up to the first collision of each chain, rigid: eqs 3-5 and the sentence after them.

    Attributes:
        phase: omega t of the two collisions, [chain].
        striker, target: velocities before, [chain], in units of V.
        other_bead: displacement of bead 1 of chain 2 at the first collision, as a share of D.
    """

    phase: Floats
    striker: Floats
    target: Floats
    other_bead: float


def first_row(theta: float) -> FirstRow:
    """The first collision of each chain at some theta.

    Raises:
        ValueError: a chain's first two beads never meet.
    """
    problem = rigid_problem(theta, 2)
    found = collisions.run(problem)
    first = [np.flatnonzero((found.row == 1) & (found.chain == chain))[:1] for chain in (1, 2)]
    if not all(len(index) for index in first):
        raise ValueError(f"theta = {theta:g}: a chain's first two beads never meet")
    index = np.concatenate(first)
    start = collisions.sample(found, found.time[index[:1]])
    share = float(start.displacement[0, 1, 0]) / physics.gap(problem.system)
    return FirstRow(found.time[index].copy(), found.striker[index], found.target[index], share)


# --- scan over theta --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Scan:
    """First impulses of rigid rows over theta.

    Attributes:
        theta: [theta].
        bead: [row], numbers of the beads.
        first: [theta, chain, row], 0 where a bead had no collision.
    """

    theta: Floats
    bead: NDArray[np.int64]
    first: Floats

    def difference(self) -> Floats:
        """Difference of the chains, [theta, row]: (largest - smallest) / mean; 2 where one chain received nothing."""
        return np.array([relative_difference(first) for first in self.first])

    def keeping(self, first_bead: int, last_bead: int, tolerance: float = AGREE) -> Floats:
        """The thetas at which the chains of every row in a range agree."""
        rows = (self.bead >= first_bead) & (self.bead <= last_bead)
        return self.theta[np.all(self.difference()[:, rows] <= tolerance, axis=1)]


def scan(thetas: Iterable[float], last_bead: int = 30) -> Scan:
    """Rigid rows at many thetas; some 2 ms each."""
    values = np.array(list(thetas))
    bead = np.arange(2, last_bead + 1)
    first = np.array([rigid_impulses(rigid_problem(theta, last_bead)).first[:, : len(bead)] for theta in values])
    return Scan(values, bead, first)


def sensitivity(thetas: Iterable[float], bead: int = 25, change: float = 1e-13) -> Floats:
    """Largest change of a rigid row's first impulses when D changes by a relative amount, [theta].

    Late rows amplify rounding: where this is not small, the impulse is a property of the arithmetic, not of theta.
    """
    result = []
    for theta in thetas:
        one, other = (
            rigid_impulses(rigid_problem(value, bead)).first[:, bead - 2] for value in (theta, theta * (1.0 + change))
        )
        result.append(float(np.max(np.abs(one - other))))
    return np.array(result)


# --- equipartition of gapped Hertz beads ------------------------------------------------------------------------------


@dataclass(frozen=True)
class RelativeMode:
    """The difference of the chains over the rows.

    Attributes:
        bead: [row].
        difference: (I_1 - I_2) / (I_1 + I_2) of the first impulses, [row]; NaN where nothing passed.
        rows_per_e: rows in which its size falls by e, by least squares of its logarithm; inf where it does not fall.
        equal_from: first bead from which on the chains agree to `AGREE`; None if they never do, or only at the end.
    """

    bead: NDArray[np.int64]
    difference: Floats
    rows_per_e: float
    equal_from: int | None


def relative_mode(impulses: Impulses, first_bead: int, last_bead: int) -> RelativeMode:
    """The relative mode of two chains between two rows; fits take every row, so a sign change is a dip in them."""
    rows = slice(impulses.row(first_bead), impulses.row(last_bead) + 1)
    bead, first = impulses.bead[rows], impulses.first[:, rows]
    with np.errstate(invalid="ignore", divide="ignore"):
        difference = (first[0] - first[1]) / first.sum(axis=0)
    fitted = np.isfinite(difference) & (difference != 0.0)
    slope = float(np.polyfit(bead[fitted], np.log(np.abs(difference[fitted])), 1)[0])
    apart = np.flatnonzero(~(2.0 * np.abs(difference) <= AGREE))
    start = int(apart[-1]) + 1 if len(apart) else 0
    equal_from = int(bead[start]) if start < len(bead) - 5 else None
    return RelativeMode(bead, difference, -1.0 / slope if slope < 0.0 else math.inf, equal_from)


# --- rigid beads as a limit -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class RigidLimit:
    """Gapped Hertz beads at fixed theta as kappa falls, against rigid ones.

    Attributes:
        kappa: [kappa], falling.
        bead: [row].
        rigid: first impulses of rigid beads, [chain, row].
        hertz: the same of Hertz beads, [kappa, chain, row].
        difference: largest over the chains, [kappa, row].
        rate: exponent p of ``difference ~ kappa**p`` of each row, over the last three kappas, [row].
    """

    kappa: Floats
    bead: NDArray[np.int64]
    rigid: Floats
    hertz: Floats
    difference: Floats
    rate: Floats


def rigid_limit(
    theta: float = 1.0, kappas: Sequence[float] = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6), last_bead: int = 4
) -> RigidLimit:
    """The limit in which Hertz beads with gaps become rigid ones.

    A contact lasts about 2.44 T and a period 2 pi / sqrt(2 kappa) T, so their ratio, and with it the difference, falls
    as sqrt(kappa): rate 1/2. At larger kappa a bead may collide in one model only, the more so the farther along the
    chain: the limit is reached row by row.
    """
    bead = np.arange(2, last_bead + 1)
    rigid = rigid_impulses(rigid_problem(theta, last_bead)).first[:, : len(bead)]
    hertz = np.array([hertz_impulses(problem_at(theta, kappa, last_bead)).first[:, : len(bead)] for kappa in kappas])
    difference = np.max(np.abs(hertz - rigid), axis=1)
    rate = np.polyfit(np.log(kappas[-3:]), np.log(difference[-3:]), 1)[0]
    return RigidLimit(np.array(kappas), bead, rigid, hertz, difference, np.asarray(rate))
