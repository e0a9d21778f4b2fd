"""Impulses of contacts: what two beads exchanged in their first contact and in all of them.

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
from functools import cached_property
from typing import NamedTuple

import numpy as np

from analysis import hermite, motion
from analysis.meters import Meter, Part
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, System, physics
from lammps_inputs.facts import Fact

TOUCH = 1e-12
"""Overlap from which on a contact counts as closed, in units of L; its force, 1e-18, is no impulse."""

PANEL = 0.025
"""Largest stretch of time for one Gauss rule of four nodes. Where a contact opens or closes the force is a power 3/2,
on which the rule errs by some 1e-3 PANEL**2.5 = 1e-7."""


@dataclass(frozen=True)
class Impulses:
    """Impulses of contacts, [chain, row].

    Attributes:
        bead: number of the bead of each row, which the contact with the bead before it pushes.
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

    def pushed(self, direction: int) -> Integers:
        """Number of the bead that the contact of each row pushes in a direction, [row]: 1 or -1."""
        return self.bead if direction > 0 else self.bead - 1

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


class _Pushes(NamedTuple):
    """Contacts in a part of a run that press in an interval between two frames, [push] in the order of time.

    Attributes:
        chain, row: [push] positions.
        total: impulse in the interval, in units of m V.
        first: impulse until a contact opens in it.
        moment: integral of force and time until then.
        opens: whether a contact opens in it.
        closes: number of contacts that close in it.
        touching: [chain, row] number of contacts at the start of the run.
        velocity: of the first and of the last frame of the part, [first or last, chain, bead] in units of V.
    """

    chain: Integers
    row: Integers
    total: Floats
    first: Floats
    moment: Floats
    opens: Flags
    closes: Integers
    touching: Integers
    velocity: Floats


@dataclass(frozen=True)
class ImpulseMeter(Meter[_Pushes, Impulses]):
    """Impulses of contacts between beads that are held side by side.

    Between two frames the overlap follows the polynomial of degree five through its value and two derivatives there
    (degree three, where the beads around were not recorded); the force of that is integrated by Gauss rules. At the
    default cadence the error is below 1e-6, and 4e-4 with frames 1 T apart.

    Attributes:
        problem: what is run.
    """

    problem: Problem

    @cached_property
    def _behind(self) -> Integers:
        """Position of the bead behind each row, [row], along the last axis."""
        return np.flatnonzero(np.diff(self.problem.rows.numbers) == 1)

    @cached_property
    def _bead(self) -> Integers:
        """Number of the bead that receives the impulses of each row, [row]."""
        return np.asarray(self.problem.rows.numbers[self._behind] + 1)

    def of_part(self, part: Part) -> _Pushes:
        """Impulses between the frames of a part, to the first of the next."""
        block = part.to_next
        overlap = self._overlaps(block)
        rate = block.velocity[..., self._behind] - block.velocity[..., self._behind + 1]
        spacing = block.spacing if block.frames > 1 else 0.0
        meets = (rate[:-1] > 0.0) & (rate[1:] < 0.0) & (overlap[:-1] + rate[:-1] * spacing > TOUCH)
        frame, chain, row = np.nonzero((overlap[:-1] > TOUCH) | (overlap[1:] > TOUCH) | meets)
        touching = overlap[0] > TOUCH if part.start == 0 else np.zeros(overlap[0].shape, dtype=bool)
        velocity = block.velocity[[0, part.count - 1]]
        if len(frame) == 0:
            none, nowhere = np.zeros(0), np.zeros(0, dtype=np.int64)
            return _Pushes(chain, row, none, none, none, none > 0.0, nowhere, touching.astype(np.int64), velocity)
        states = np.array([motion.strain_and_rates(block, at, chain, self._behind[row]) for at in (frame, frame + 1)])
        states[:, 0] = overlap[frame, chain, row], overlap[frame + 1, chain, row]
        polynomial = hermite.coefficients((0, 1), states, spacing)
        node, weight = _gauss(spacing)
        between = np.stack([hermite.value(polynomial, np.full(len(frame), s)) for s in node])
        contact = chain, self._bead[row] - 2
        above_rest = motion.contact_force(self.problem.system, between, *contact) - motion.static_force(
            self.problem.system, *contact
        )
        push = above_rest * weight[:, np.newaxis] * spacing
        closed = np.stack([overlap[frame, chain, row], *between, overlap[frame + 1, chain, row]]) > TOUCH
        opening = closed[:-1] & ~closed[1:]
        before = np.cumsum(opening, axis=0)[:-1] == 0  # of each node: whether no contact has ended in this interval
        when = block.time[frame] + node[:, np.newaxis] * spacing
        return _Pushes(
            chain,
            row,
            _in_order(push),
            _in_order(push * before),
            _in_order(push * before * when),
            np.any(opening, axis=0),
            np.sum(~closed[:-1] & closed[1:], axis=0),
            touching.astype(np.int64),
            velocity,
        )

    def result(self, pieces: list[_Pushes]) -> Impulses:
        """The impulses of all frames."""
        chain, row, total, first, moment, opens, closes = (
            np.concatenate(values) for values in list(zip(*pieces, strict=True))[:7]
        )
        shape = pieces[0].touching.shape
        order, end = np.arange(len(chain)), np.full(shape, len(chain))
        np.minimum.at(end, (chain[opens], row[opens]), order[opens])
        in_first = order <= end[chain, row]
        totals, firsts, moments = np.zeros((3, *shape))
        contacts = pieces[0].touching.copy()
        # term by term: a sum must not depend on where parts begin
        np.add.at(totals, (chain, row), total)
        np.add.at(firsts, (chain[in_first], row[in_first]), first[in_first])
        np.add.at(moments, (chain[in_first], row[in_first]), moment[in_first])
        np.add.at(contacts, (chain, row), closes)
        imbalance = float("nan")
        if self.problem.rows.neighbours and self.problem.system.holds(Fact.MOMENTUM):
            change = pieces[-1].velocity[1] - pieces[0].velocity[0]
            gained = (change * self.problem.system.mass).sum(axis=0)
            ahead = np.cumsum(gained[::-1])[::-1][1:]
            imbalance = float(np.max(np.abs(totals.sum(axis=0) - ahead)))
        with np.errstate(invalid="ignore", divide="ignore"):
            time = moments / firsts
        return Impulses(self._bead, firsts, totals, contacts, time, imbalance)

    def _overlaps(self, block: Trajectory) -> Floats:
        x = block.displacement
        strain = x[..., self._behind] - x[..., self._behind + 1]
        chain = np.arange(self.problem.chains)[:, np.newaxis]
        return np.asarray(strain + motion.rest_overlap(self.problem.system, chain, self._bead - 2))


def _in_order(values: Floats) -> Floats:
    """Sum over nodes, [push] from [node, push], term by term: it must not depend on how many there are at once."""
    return np.asarray(np.add.accumulate(values, axis=0)[-1])


def meter_of(problem: Problem) -> ImpulseMeter | None:
    """A meter of the impulses by which chains are compared; None where they are not, or not all beads are recorded."""
    measured = problem.rows.complete and compared_by_impulses(problem.system)
    return ImpulseMeter(problem) if measured else None


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
    return ImpulseMeter(problem).read(blocks)


def _gauss(spacing: float) -> tuple[Floats, Floats]:
    """Nodes and weights, each [node], on 0 to 1 of four-node Gauss rules on panels of at most `PANEL`."""
    panels = max(1, int(np.ceil(spacing / PANEL * (1.0 - 1e-9))))
    node, weight = np.polynomial.legendre.leggauss(4)
    nodes = (np.arange(panels)[:, np.newaxis] + 0.5 + 0.5 * node) / panels
    return nodes.ravel(), np.tile(0.5 * weight / panels, panels)
