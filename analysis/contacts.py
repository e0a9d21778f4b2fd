"""The largest overlap of contacts that the frames of a run show."""

import math
from dataclasses import dataclass

import numpy as np

from analysis import motion
from analysis.meters import Meter, Part
from analysis.trajectory import Floats
from lammps_inputs import Problem, laws, physics

FARTHEST = 0.25
"""Time between frames, in units of T in contacts of strength 1, up to which they show the largest overlap to 2 %.

An overlap d falls by at most ``d**1.5 t**2`` in a time t from its maximum, for no contact is opposed by more than its
own force on two beads; springs apart, which pull by little at that moment. Frames are half of this away at most.
Stiff contacts of light beads are over sooner, by the square root of ``mass / strength``.
"""


def shown_by_frames(problem: Problem) -> bool:
    """Whether the frames hold neighbouring beads, closely enough in time."""
    system = problem.system
    quicker = physics.pulse_time(system)
    if not physics.one_kind(system):
        strength = max(float(np.max(laws.strength(link.law))) for link in system.contacts)
        quicker = min(1.0, math.sqrt(float(np.min(system.mass)) / strength))
    return problem.forces_known and problem.every <= FARTHEST * quicker * (1.0 + 1e-9)


@dataclass(frozen=True)
class OverlapMaxima:
    """Largest overlaps of contacts in some frames.

    Attributes:
        value: largest overlap of any contact, in units of L; negative where none has touched, -inf where nothing moves.
        each: largest overlap of every contact, [chain, contact], where beads differ; else None.
        walls: largest overlap of the contacts with each wall, [wall, chain], in the order of `System.walls`.
    """

    value: float
    each: Floats | None
    walls: Floats


@dataclass(frozen=True)
class OverlapMeter(Meter[OverlapMaxima, OverlapMaxima]):
    """Largest overlaps in a run of all beads.

    Attributes:
        problem: what was run.
    """

    problem: Problem

    def of_part(self, part: Part) -> OverlapMaxima:
        """The largest in the frames of a part."""
        block, problem = part.frames, self.problem
        system = problem.system
        at_walls = np.empty((len(system.walls), problem.chains))
        for largest, link in zip(at_walls, system.walls, strict=True):
            largest[:] = np.max(link.overlap(block.displacement), axis=0)[:, 0]
        moving = slice(0, problem.beads) if physics.loaded(system) else block.moving  # beads at rest touch, or overlap
        x = block.displacement[..., moving]
        contacts = problem.beads - (not system.closing)
        each = None if physics.one_kind(system) else np.full((problem.chains, contacts), -math.inf)
        if x.shape[-1] < 2:
            return OverlapMaxima(-math.inf, each, at_walls)
        overlaps = motion.overlaps(system, x, moving.start + 1)
        if each is not None:
            each[:, moving.start : moving.start + overlaps.shape[-1]] = np.max(overlaps, axis=0)
        return OverlapMaxima(float(np.max(overlaps)), each, at_walls)

    def result(self, pieces: list[OverlapMaxima]) -> OverlapMaxima:
        """The largest in all frames."""
        each = [piece.each for piece in pieces if piece.each is not None]
        return OverlapMaxima(
            max(piece.value for piece in pieces),
            np.max(each, axis=0) if each else None,
            np.max([piece.walls for piece in pieces], axis=0),
        )


def overlap_meter(problem: Problem) -> OverlapMeter | None:
    """A meter of the largest overlaps; None where the frames do not show them."""
    return OverlapMeter(problem) if shown_by_frames(problem) else None
