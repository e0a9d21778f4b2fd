"""Contacts over a run: the largest overlap that its frames show, and what contacts that yield keep.

That is the largest force and overlap of each, the permanent overlap, and the energy lost.
"""

import math
from dataclasses import dataclass

import numpy as np

from analysis import motion
from analysis.quantity import declare, result
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, laws, physics

FARTHEST = 0.25
"""Time between frames, in units of T, up to which they show the largest overlap to two per cent.

An overlap d falls by at most ``d**1.5 t**2`` in a time t from its maximum, for no contact is opposed by more than its
own force on two beads; springs apart, which pull by little at that moment. Frames are half of this away at most.
Stiff contacts of light beads are over sooner, by the square root of ``mass / strength``.
"""


def shown_by_frames(problem: Problem) -> bool:
    """Whether the frames hold neighbouring beads, closely enough in time."""
    system = problem.system
    quicker = 1.0
    if not physics.one_kind(system):
        strength = max(float(np.max(laws.strength(link.law))) for link in system.along)
        quicker = min(1.0, math.sqrt(float(np.min(system.mass)) / strength))
    return problem.forces_known and problem.every <= FARTHEST * quicker * (1.0 + 1e-9)


class LargestOverlap:
    """Collects the largest overlaps in a run that is given block by block, with all beads recorded.

    Attributes:
        value: largest overlap so far, in units of L; negative where none has touched, -inf before the first frame.
        each: largest overlap of every contact so far, [chain, contact], where beads differ; else None.
        walls: largest overlap of the contacts with each wall so far, [chain], in the order of `physics.walls`.
    """

    def __init__(self) -> None:
        self.value = -math.inf
        self.each: Floats | None = None
        self.walls: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take more frames into account."""
        problem = block.problem
        system = problem.system
        walls = physics.walls(system)
        if not self.walls:
            self.walls = [np.full(problem.chains, -math.inf) for _ in walls]
        for largest, link in zip(self.walls, walls, strict=True):
            place = problem.beads - 1 if link.side > 0.0 else 0
            law = laws.at(link.law, np.arange(problem.chains), place)
            strain = np.max(link.side * block.displacement[..., place], axis=0)
            np.maximum(largest, strain - link.gap + laws.rest(law), out=largest)
        moving = slice(0, problem.beads) if physics.loaded(system) else block.moving  # beads at rest touch, or overlap
        x = block.displacement[..., moving]
        if not physics.one_kind(system) and self.each is None:
            self.each = np.full((problem.chains, problem.beads - 1), -math.inf)
        if x.shape[-1] > 1:
            overlaps = motion.overlaps(system, x, moving.start + 1)
            self.value = float(np.maximum(self.value, np.max(overlaps)))
            if self.each is not None:
                of_moving = self.each[:, moving.start : moving.start + overlaps.shape[-1]]
                np.maximum(of_moving, np.max(overlaps, axis=0), out=of_moving)


LEAST_CONTACTS = 10
"""Contacts along a chain from which on an exponent is fitted."""


@result
class Yielded:
    """The contacts of all chains at the end of the run, without walls."""

    contacts: int = declare("number of contacts with a permanent overlap", column="contacts with a permanent overlap")
    permanent: float = declare(
        "largest permanent overlap", "length", symbol="\\delta_r", column="largest permanent overlap"
    )
    dissipated: float = declare(
        "energy dissipated in contacts of beads over the energy input of the kicks",
        undefined="a push or drive supplies energy",
        column="energy dissipated in plastic contacts / energy input",
    )
    decay: float = declare(
        "exponent of the largest force of the contacts of the kicked chain over their number, fitted over the second "
        "half of those that have begun to open",
        undefined=f"fewer than {LEAST_CONTACTS} of these",
        column="decay exponent of the largest contact forces",
    )


@result
class YieldTable:
    """Table of the contacts of all chains at the end of the run."""

    chain: Integers = declare("number of the chain")
    contact: Integers = declare("number of the contact, that of the bead behind it")
    overlap: Floats = declare("largest overlap so far", "length", symbol="\\delta_m")
    force: Floats = declare("largest force so far: that of first loading at this overlap", "force", symbol="F_m")
    permanent: Floats = declare("permanent overlap", "length", symbol="\\delta_r")
    opened: Integers = declare(
        "whether it has begun to open, 0 or 1; of one that has not the record ends before its largest overlap"
    )
    dissipated: Floats = declare("energy dissipated by yielding", "energy")


class YieldMeter:
    """Reads the last frame of a run of all beads."""

    def __init__(self) -> None:
        self._last: Trajectory | None = None

    @staticmethod
    def applies(problem: Problem) -> bool:
        """Whether frames hold the states of contacts that yield."""
        return bool(problem.state_columns)

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._last = block.last()

    def result(self) -> tuple[Yielded, YieldTable] | None:
        """Permanent overlaps at the last frame so far, and their table; None if no frame has states of contacts."""
        last = self._last
        if last is None or last.contact_state is None:
            return None
        system = last.system_at(-1)
        link = system.along[0]
        law = link.law
        shape = (system.chains, system.beads - 1)
        largest = laws.turning_overlap(law)
        force = np.broadcast_to(laws.whole_force(law, largest), shape)
        permanent, dissipated = (
            np.broadcast_to(find(*law), shape)
            for find in (law.permanent, law.dissipated)  # type: ignore[attr-defined]
        )
        chain, contact = np.indices(shape)
        opened = (motion.overlaps(system, last.displacement[-1]) < largest) & (largest > 0.0)
        table = YieldTable(
            chain=chain.ravel() + 1,
            contact=contact.ravel() + 1,
            overlap=largest.ravel(),
            force=force.ravel(),
            permanent=permanent.ravel(),
            opened=opened.ravel().astype(np.int64),
            dissipated=dissipated.ravel(),
        )
        kicked = physics.largest_excitation(system)[0] - 1
        acted_on = physics.acted_on(system)
        decay = power_law(force[kicked], opened[kicked])
        return (
            Yielded(
                contacts=int(np.count_nonzero(permanent > 0.0)),
                permanent=float(np.max(permanent)),
                dissipated=float("nan") if acted_on else float(np.sum(dissipated)) / physics.energy(system),
                decay=float("nan") if decay is None else decay.exponent,
            ),
            table,
        )


@dataclass(frozen=True)
class PowerLaw:
    """Largest force of contacts as ``factor * contact**exponent``.

    Attributes:
        contact: [contact] numbers of the fitted contacts, the second half of those that have begun to open.
        factor: dimensionless force of contact 1.
        exponent: slope of the logarithms.
    """

    contact: Floats
    factor: float
    exponent: float


def power_law(force: Floats, opened: Flags) -> PowerLaw | None:
    """Law of the forces [contact] of one chain, by least squares of logarithms; None for too few contacts that opened.

    Args:
        force: [contact] largest force so far, dimensionless.
        opened: [contact] whether the contact has begun to open.
    """
    count = int(np.argmin(opened)) if not np.all(opened) else len(opened)
    if count < 2 * LEAST_CONTACTS:
        return None
    contact = np.arange(count // 2, count, dtype=np.float64) + 1.0
    exponent, logarithm = np.polyfit(np.log(contact), np.log(force[count // 2 : count]), 1)
    return PowerLaw(np.asarray(contact), math.exp(logarithm), float(exponent))
