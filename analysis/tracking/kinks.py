"""What contacts and walls that close or open near a frame do to a maximum: forces that no polynomial follows.

A force that begins as a power of time, ``(t - a)**power`` from a on, is fitted between two frames like any other, with
velocity and its first two derivatives at both. How far that is off depends on the power and on where it begins only.
"""

from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis import hermite, motion
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem, laws, physics
from lammps_inputs.laws import dashpot
from lammps_inputs.laws.wall import clearance

Integers = NDArray[np.int64]
Forces = Iterator[tuple[float, Floats]]

FARTHEST = 3.0
"""Frames before the first of the two from which on a beginning is followed."""

NEAREST = 1e-4
"""Distance, in frames, of a beginning from the frame that sees it; nearer ones are taken to be there."""

DOUBT = (0.7, 1.0, 1.4)
"""Of the distance of a beginning, which is told from the overlap and its rate at the frame that sees it."""

MARGIN = 1.1
"""For the samples of which tables are made, and a rate that is taken to be steady."""

_SAMPLES = np.linspace(0.0, 1.0, 65)


def kinks(block: Trajectory, start: Integers, chain: Integers, bead: Integers) -> Floats:
    """How far a bead's velocity between a frame and the next may be off, and its slope a frame, [0 or 1, bead].

    Args:
        block: frames.
        start: the first frame of each.
        chain, bead: positions of the beads in the block, all of which are recorded.
    """
    problem, place = block.problem, block.first - 1 + bead
    system = problem.system
    at = np.stack([start, np.minimum(start + 1, block.frames - 1)])  # [frame, bead], as what is made with it
    x, v = (values[at, chain, bead] for values in (block.displacement, block.velocity))
    off = np.zeros((2, len(start)))
    for side in (-1, 1):
        there = (bead + side >= 0) & (bead + side < block.velocity.shape[2])
        other, contact = np.where(there, bead + side, bead), np.minimum(place, place + side)
        overlap = side * (x - block.displacement[at, chain, other]) - physics.gap(system)
        overlap += motion.rest_overlap(system, chain, contact)
        closing = side * (v - block.velocity[at, chain, other])
        forces = partial(_of_contacts, problem, chain, np.clip(contact, 0, problem.beads - 2))
        off += np.where(there, _by(forces, overlap, closing, block.spacing), 0.0)
    for wall in physics.walls(system):
        law: Any = wall.law
        there = place == (problem.beads - 1 if law.side > 0.0 else 0)
        forces = partial(_of_wall, problem, law, chain, place)
        overlap, closing = law.side * x - clearance(law)[chain, place], law.side * v
        off += np.where(there, _by(forces, overlap, closing, block.spacing), 0.0)
    return np.asarray(off / physics.mass_of(system, chain, place))


def _by(forces: Callable[[Floats, Floats], Forces], overlap: Floats, closing: Floats, spacing: float) -> Floats:
    """The same of what pushes beads with these overlaps, and their rates, at both frames, [frame, bead]."""
    pressed, rate = overlap > 0.0, np.abs(closing)
    between = pressed[0] != pressed[1]
    # what has just closed before the first frame, and what will soon open after the second
    near = pressed & (between | (np.array([[1.0], [-1.0]]) * closing > 0.0)) & (rate > 0.0)
    away = np.where(near, overlap / np.where(near, rate * spacing, 1.0), np.inf).min(axis=0)
    most: Floats = rate.max(axis=0)
    found = (force * unfollowed(power, away, between) for power, force in forces(most * spacing, most))
    return np.asarray(spacing * sum(found))


def _of_contacts(problem: Problem, chain: Integers, contact: Integers, overlap: Floats, rate: Floats) -> Forces:
    """As which power of time the forces of contacts begin, and what they are a frame later."""
    system = problem.system
    yield physics.exponent(system) or 1.5, motion.contact_force(system, overlap, chain, contact)
    loss: Any = physics.contact_loss(system)
    if loss is not None:
        yield _of_dashpot(laws.at(loss, chain, contact)._replace(rest=0.0), overlap, rate)


def _of_wall(problem: Problem, law: Any, chain: Integers, bead: Integers, overlap: Floats, rate: Floats) -> Forces:
    """The same of a wall's."""
    yield law.exponent, law.strength[chain, bead] * overlap**law.exponent
    loss: Any = physics.wall_loss(problem.system, law.side)
    if loss is not None:
        yield _of_dashpot(laws.at(loss, chain, bead)._replace(rest=0.0, side=1.0), overlap, rate)


def _of_dashpot(law: Any, overlap: Floats, rate: Floats) -> tuple[float, Floats]:
    one, two = (float(np.max(dashpot.resistance(law, np.float64(much)))) for much in (1.0, 2.0))
    power = float(np.log2(two / one)) if one > 0.0 else 0.0
    return power, dashpot.resistance(law, overlap) * rate


def unfollowed(power: float, away: Floats, between: NDArray[np.bool_]) -> Floats:
    """Errors of velocity, and of its slope, by a force that is ``time**power`` after it begins, [0 or 1, ...].

    In frames; the largest of what is as likely by `DOUBT`.

    Args:
        power: 0 for a force that jumps.
        away: distance of the beginning from the frame that sees it; inf: nothing begins.
        between: whether that is between the two frames, else before both.
    """
    found = np.zeros((2, *np.shape(away)))
    for factor in DOUBT:
        distance = np.clip(factor * away, NEAREST, None)
        begin = np.where(between, 1.0 - np.minimum(distance, 1.0), -distance)
        grid, *errors = _table(power)
        for k, error in enumerate(errors):
            found[k] = np.fmax(found[k], np.interp(begin, grid, error, left=0.0))
    return MARGIN * found


@lru_cache
def _table(power: float) -> tuple[Floats, Floats, Floats]:
    """Where forces begin, in frames, and the errors."""
    near = np.geomspace(NEAREST, 0.5, 60)
    begin = np.concatenate([-np.geomspace(FARTHEST, NEAREST, 100), near, 1.0 - near[::-1]])

    def states(s: float) -> Floats:
        """Velocity, force and its rate at a time, [3, begin]."""
        since = np.maximum(s - begin, 0.0)
        on = since > 0.0
        rate = np.where(on & (power > 0.0), power * np.where(on, since, 1.0) ** (power - 1.0), 0.0)
        return np.array([since ** (power + 1.0) / (power + 1.0), np.where(on, since**power, 0.0), rate])

    fitted = hermite.coefficients((0, 1), np.array([states(0.0), states(1.0)]), 1.0)
    slope = hermite.derivative(fitted)
    worst = np.zeros((2, len(begin)))
    for s in _SAMPLES.tolist():
        at = np.full(len(begin), s)
        velocity, force, _ = states(s)
        worst[0] = np.fmax(worst[0], np.abs(hermite.value(fitted, at) - velocity))
        worst[1] = np.fmax(worst[1], np.abs(hermite.value(slope, at) - force))
    return begin, worst[0], worst[1]
