"""Impulses of contacts: what each bead got from the bead behind it, in its first contact and in all of them.

Row n stands for the contact of bead n with bead n - 1, so the first row has none. In units of m V: a bead
at rest leaves such a contact with its impulse as velocity; under a static load, of the force above that.
The force is integrated between frames along a polynomial of the overlap (`ImpulseMeter`). An engine whose frames
hold no overlaps gives the impulses itself.

By them chains with gaps are compared (`compared_by_impulses`): a bead that flies freely exchanges its velocity with
its neighbours in the other chains, so that the peak velocities of a row level out whatever it received.

The error of those of frames follows from the momentum of all beads ahead, which grows by what passes a row (springs are
within a row and cancel): `Impulses.imbalance`.

Plug-ins take this module for impulses of contacts: `measure` reads them from frames, an engine of rigid beads makes
`Impulses` itself, `relative_difference` compares the chains.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> received = impulses.measure(problem, frames.blocks())
    >>> received.bead[:3], received.first[0, :3].round(3)  # of chain 1, in m V
    (array([2, 3, 4]), array([1.071, 1.101, 1.117]))
    >>> received.contacts[0, -2:]  # of beads 19 and 20
    array([1, 1])
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from analysis import hermite, motion
from analysis.trajectory import (
    Floats,
    Integers,
    Trajectory,
    joined,
    mirrored,
    mirrored_problem,
    watch,
)
from lammps_inputs import Problem, System, physics
from lammps_inputs.facts import Fact

TOUCH = 1e-12
"""Overlap from which on a contact counts as closed, in units of L; its force, 1e-18, is no impulse."""

PANEL = 0.025
"""Largest stretch of time for one Gauss rule of four nodes. Where a contact opens or closes the force is a power 3/2,
on which the rule errs by some 1e-3 PANEL**2.5 = 1e-7."""


@dataclass(frozen=True)
class Impulses:
    """Impulses on beads from behind, [chain, row].

    Attributes:
        bead: number of the receiving bead of each row.
        first: impulse of the first contact (so far, if it still lasts), in units of m V; 0 where there was none.
        total: impulse of all contacts together, in units of m V.
        contacts: number of contacts.
        time: time of the first contact, the mean over its force, in units of T; NaN where there was none.
        imbalance: largest difference, over the rows, between the sum of ``total`` over the chains and the momentum that
            the beads ahead gained, which are equal; NaN where not all beads are known, or momentum does not stay.
    """

    bead: Integers
    first: Floats
    total: Floats
    contacts: Integers
    time: Floats
    imbalance: float

    def row(self, bead: int) -> int:
        """Position of the row in which a bead receives its impulse.

        Raises:
            ValueError: the bead is not among those of the rows.
        """
        positions = np.flatnonzero(self.bead == bead)
        if len(positions) == 0:
            raise ValueError(f"bead {bead} and the bead behind it were not both recorded")
        return int(positions[0])


def compared_by_impulses(system: System) -> bool:
    """Whether springs across change the velocities of beads that fly freely between their contacts."""
    return physics.gap(system) > 0.0 and physics.coupled(system)


def relative_difference(impulse: Floats) -> Floats:
    """Relative difference of the impulses of chains: (largest - smallest) / mean.

    Args:
        impulse: [chain, row] in units of m V.

    Returns:
        [row] dimensionless; NaN where the mean is not positive.
    """
    mean = impulse.mean(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(mean > 0.0, (impulse.max(axis=0) - impulse.min(axis=0)) / mean, np.nan)


class ImpulseMeter:
    """Measures impulses in a run that is given piece by piece; holds one frame and what it found.

    Between two frames the overlap follows the polynomial of degree five through its value and two derivatives there
    (degree three, where the beads around were not recorded); the force of that is integrated by Gauss rules. At the
    default cadence the error is below 1e-6, and 4e-4 with frames 1 T apart.

    Args:
        problem: what is run.
        direction: 1, or -1 for the impulses that beads receive from the bead ahead, with beads counted from the last.
    """

    def __init__(self, problem: Problem, direction: int = 1) -> None:
        beads = problem.rows.numbers
        self.problem = problem if direction > 0 else mirrored_problem(problem)
        self._direction = direction
        self._pair = np.flatnonzero(np.diff(beads) == 1)
        self._bead = beads[self._pair] + 1
        shape = (problem.chains, len(self._pair))
        self._first, self._total, self._moment = np.zeros((3, *shape))
        self._contacts = np.zeros(shape, dtype=np.int64)
        self._over = np.zeros(shape, dtype=bool)
        self._start: Floats | None = None
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        block = block if self._direction > 0 else mirrored(block)
        if self._carried is None:
            self._start = block.velocity[0].copy()
            self._contacts += self._overlaps(block[:1])[0] > TOUCH
        else:
            block = joined([self._carried, block])
        if block.frames > 1:
            self._integrate(block)
        self._carried = block.last()

    def result(self) -> Impulses:
        """The impulses of all frames so far.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None or self._start is None:
            raise ValueError("no frames to measure")
        imbalance = float("nan")
        if self.problem.rows.neighbours and self.problem.system.holds(Fact.MOMENTUM):
            gained = ((self._carried.velocity[0] - self._start) * self.problem.system.mass).sum(axis=0)
            ahead = np.cumsum(gained[::-1])[::-1][1:]
            imbalance = float(np.max(np.abs(self._total.sum(axis=0) - ahead)))
        with np.errstate(invalid="ignore", divide="ignore"):
            time = self._moment / self._first
        return Impulses(self._bead, self._first.copy(), self._total.copy(), self._contacts.copy(), time, imbalance)

    def _overlaps(self, block: Trajectory) -> Floats:
        x = block.displacement
        strain = x[..., self._pair] - x[..., self._pair + 1] - physics.gap(self.problem.system)
        chain = np.arange(self.problem.chains)[:, np.newaxis]
        return np.asarray(strain + motion.rest_overlap(self.problem.system, chain, self._bead - 2))

    def _integrate(self, block: Trajectory) -> None:
        """Add the impulses between the frames of a block."""
        spacing = block.spacing
        overlap = self._overlaps(block)
        rate = block.velocity[..., self._pair] - block.velocity[..., self._pair + 1]
        meets = (rate[:-1] > 0.0) & (rate[1:] < 0.0) & (overlap[:-1] + rate[:-1] * spacing > TOUCH)
        frame, chain, pair = np.nonzero((overlap[:-1] > TOUCH) | (overlap[1:] > TOUCH) | meets)
        if len(frame) == 0:
            return
        states = np.array([motion.strain_and_rates(block, at, chain, self._pair[pair]) for at in (frame, frame + 1)])
        states[:, 0] = overlap[frame, chain, pair], overlap[frame + 1, chain, pair]
        polynomial = hermite.coefficients((0, 1), states, spacing)
        node, weight = _gauss(spacing)
        between = np.stack([hermite.value(polynomial, np.full(len(frame), s)) for s in node])
        contact = chain, self._bead[pair] - 2
        above_rest = motion.contact_force(self.problem.system, between, *contact) - motion.static_force(
            self.problem.system, *contact
        )
        push = above_rest * weight[:, np.newaxis] * spacing
        closed = np.stack([overlap[frame, chain, pair], *between, overlap[frame + 1, chain, pair]]) > TOUCH
        opening = closed[:-1] & ~closed[1:]
        before = np.cumsum(opening, axis=0)[:-1] == 0  # of each node: whether no contact has ended in this interval

        over = np.zeros((block.frames, *self._over.shape), dtype=bool)
        over[0] = self._over
        over[frame + 1, chain, pair] = opening.any(axis=0)
        over = np.logical_or.accumulate(over, axis=0)
        still_first = before & ~over[frame, chain, pair]
        when = block.time[frame] + node[:, np.newaxis] * spacing
        for total, values in (
            (self._total, push),
            (self._first, push * still_first),
            (self._moment, push * still_first * when),
        ):
            # term by term: a sum is taken in another order where a block has one entry only
            np.add.at(total, (chain, pair), np.add.accumulate(values, axis=0)[-1])
        np.add.at(self._contacts, (chain, pair), np.sum(~closed[:-1] & closed[1:], axis=0))
        self._over = over[-1]


def meter_of(problem: Problem) -> ImpulseMeter | None:
    """A meter of the impulses by which chains are compared; None where they are not, or not all beads are recorded."""
    measured = problem.rows.complete and compared_by_impulses(problem.system)
    return ImpulseMeter(problem, problem.direction) if measured else None


def measure(problem: Problem, blocks: Iterable[Trajectory]) -> Impulses:
    """Impulses of contacts in a run.

    Args:
        problem: what was run.
        blocks: consecutive frames, the first frame being the start; see `ImpulseMeter`.

    Returns:
        The impulses until the last frame.

    Raises:
        ValueError: there was no frame.
    """
    return watch(ImpulseMeter(problem), blocks).result()


def _gauss(spacing: float) -> tuple[Floats, Floats]:
    """Nodes and weights, each [node], on 0 to 1 of four-node Gauss rules on panels of at most `PANEL`."""
    panels = max(1, int(np.ceil(spacing / PANEL * (1.0 - 1e-9))))
    node, weight = np.polynomial.legendre.leggauss(4)
    nodes = (np.arange(panels)[:, np.newaxis] + 0.5 + 0.5 * node) / panels
    return nodes.ravel(), np.tile(0.5 * weight / panels, panels)
