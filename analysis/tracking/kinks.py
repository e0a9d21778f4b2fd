"""Errors of velocities between frames by forces that no polynomial follows.

Contacts and walls that close or open near a frame exert such forces (`kinks`). A force that begins as a power of time,
``(t - a)**power`` from a on, is fitted between two frames like any other, with velocity and its first two derivatives
at both. How far that is off depends on the power and on where it begins only.

Such a force changes the velocities of its beads, and so the force of every other dashpot and spring of these beads.
These forces begin with powers that are larger by one and by two, at beads whose contacts all stay closed, too
(`_passed_on`).
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from analysis import hermite, motion
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import laws, physics
from lammps_inputs.laws import dashpot

Forces = Iterator[tuple[float, Floats]]

FARTHEST = 3.0
"""Frames before the first of the two from which on a beginning is followed."""

NEAREST = 1e-4
"""Distance, in frames, of a beginning from the frame that sees it; nearer ones are taken to be there."""

DOUBT = (0.7, 1.0, 1.4)
"""Factors on the distance of a beginning, which follows from the overlap and its rate at the frame that sees it."""

MARGIN = 1.1
"""Factor on errors, for the finite number of samples in tables and for a rate that is taken to be constant."""

SAMPLES = 65
"""Instants between two frames at which a fit is compared with the force that it misses."""


def kinks(block: Trajectory, start: Integers, chain: Integers, bead: Integers) -> Floats:
    """Bounds on the errors of beads' velocities between a frame and the next, and of their slopes, [0 or 1, bead].

    Errors are those by forces that no polynomial follows, in units of V; slopes are per frame.

    Args:
        block: frames.
        start: [bead] position of the first of the two frames.
        chain, bead: [bead] positions of the beads in the block, all of which are recorded.
    """
    return _begun(block, start, chain, bead) + _passed_on(block, start, chain, bead)


def _passed_on(block: Trajectory, start: Integers, chain: Integers, bead: Integers) -> Floats:
    """Errors as in `kinks` by what begins at beads and their neighbours, through the dashpots and springs of a bead."""
    mass = physics.mass_of(block.problem.system, chain, block.first - 1 + bead)
    off, at_bead = np.zeros((2, len(start))), [_begun(block, start, chain, bead, more) for more in (1, 2)]
    for line, other, more, slope in _beside_bead(block, start, chain, bead):
        if np.any(slope):
            at_other = _begun(block, start, line, other, more)
            off += slope * block.spacing**more / mass * (at_bead[more - 1] + at_other)
    return off


def _beside_bead(
    block: Trajectory, start: Integers, chain: Integers, bead: Integers
) -> Iterator[tuple[Integers, Integers, int, Floats]]:
    """Chain and position of a neighbour, 1 for resistance or 2 for stiffness of a link with it, and that, [bead].

    The neighbour of a bead at a wall is the bead itself.
    """
    system = block.problem.system
    at = np.stack([start, np.minimum(start + 1, block.frames - 1)])
    x = block.displacement[at, chain, bead]
    slopes: list[tuple[int, Any, Any]] = [(1, system.dampers, dashpot.resistance), (2, system.links, laws.stiffness)]
    for order, links, slope_of in slopes:
        for link in links:
            if link.kind == "ground" or system.is_tie(link):
                continue
            for near in link.of_beads(chain, bead, block.displacement.shape[1:]):
                index = near.line, block.first - 1 + near.place
                strain = near.apart(x, block.displacement, at) - link.gap_at(*index)
                slope = np.abs(slope_of(block.law(link, at, *index), strain)).max(axis=0)
                yield *(near.other or (chain, bead)), order, np.where(near.exists, slope, 0.0)


def _begun(block: Trajectory, start: Integers, chain: Integers, bead: Integers, integrations: int = 0) -> Floats:
    """Errors as in `kinks` by forces that begin at the beads themselves.

    Args:
        block: frames.
        start: [bead] position of the first of the two frames.
        chain, bead: [bead] positions of the beads in the block.
        integrations: number of integrations over time, in frames, after which a force acts on the bead.
    """
    problem, place = block.problem, block.first - 1 + bead
    system = problem.system
    at = np.stack([start, np.minimum(start + 1, block.frames - 1)])  # [frame, bead], as what is made with it
    x, v = (values[at, chain, bead] for values in (block.displacement, block.velocity))
    off = np.zeros((2, len(start)))

    def acceleration(position: Integers) -> Floats:
        """Acceleration of beads at positions [bead], [frame, bead]."""
        return motion.acceleration_and_rate(block, at, chain, position)[0]

    for link in (*system.contacts, *system.walls):
        damper = physics.loss_beside(system, link)
        for near in link.of_beads(chain, bead, block.displacement.shape[1:]):
            index = near.line, block.first - 1 + near.place
            law, loss = block.law(link, at, *index), None if damper is None else laws.at(damper, *index)
            overlap = near.apart(x, block.displacement, at) - link.gap_at(*index) + law.rest
            closing = near.apart(v, block.velocity, at)
            forces = partial(_of_contacts, law, loss)
            pressing = _pressing(law, forces, integrations, overlap, closing, block.spacing)
            off += np.where(near.exists, pressing, 0.0)
            if loss is not None and dashpot.cut(loss):
                quickening = acceleration(bead) - (0.0 if near.other is None else acceleration(near.other[1]))
                states = np.stack([overlap, closing, near.sign * quickening])
                off += np.where(near.exists, _cut(law, loss, states, block.spacing, integrations), 0.0)
    for ground in system.ground:
        if ground.law.varies and not integrations:
            off += _bent(laws.at(ground.law, chain, place), np.abs(x).max(axis=0), block.time[at])
    return np.asarray(off / physics.mass_of(system, chain, place))


def _pressing(law: Any, forces: Callable[[Floats, Floats], Forces], integrations: int, *motions: Any) -> Floats:
    """Errors as in `_begun` by contacts that open or close, those that yield included."""
    return _by_yielding(law, *motions) if laws.has_state(law) else _by(forces, integrations, *motions)


def _bent(law: Any, strain: Floats, time: Floats) -> Floats:
    """Errors as in `kinks` by springs whose stiffness begins or ceases to change; ``time`` is [frame, bead]."""
    spacing = time[1] - time[0]
    begins, jumps = [], []
    for bend in law.bends:
        if not np.any((time[0] <= bend) & (bend <= time[1])):
            continue
        before, after = (law.now(np.full_like(strain, at)) for at in (np.nextafter(bend, -np.inf), bend))
        jump = after.change(strain, *after) - before.change(strain, *before)
        begins.append((bend - time[0]) / spacing)
        jumps.append(np.where((time[0] <= bend) & (bend <= time[1]), jump * spacing, 0.0))
    if not jumps:
        return np.zeros((2, len(strain)))
    begin, each = np.array(begins), np.array(jumps)
    return np.asarray(MARGIN * spacing * _missed(lambda s: (each * _since(s, begin, 1.0)).sum(axis=1)))


def _by(
    forces: Callable[[Floats, Floats], Forces], integrations: int, overlap: Floats, closing: Floats, spacing: float
) -> Floats:
    """Errors as in `_begun` by forces on beads with these overlaps, and their rates, at both frames, [frame, bead]."""
    pressed, rate = overlap > 0.0, np.abs(closing)
    between = pressed[0] != pressed[1]
    # what has just closed before the first frame, and what will soon open after the second
    near = pressed & (between | (np.array([[1.0], [-1.0]]) * closing > 0.0)) & (rate > 0.0)
    away = np.where(near, overlap / np.where(near, rate * spacing, 1.0), np.inf).min(axis=0)
    fastest: Floats = rate.max(axis=0)
    acting = forces(fastest * spacing, fastest)
    errors = (force * unfollowed(power, away, between, integrations) for power, force in acting)
    return np.asarray(spacing * sum(errors))


def _cut(elastic: Any, loss: Any, states: Floats, spacing: float, integrations: int = 0) -> Floats:
    """Errors as in `_begun` where tensile dashpot forces begin or cease to be cut between frames, with a kink.

    Args:
        elastic, loss: laws of the contacts, at each bead.
        states: overlap, and its first and second derivative, [derivative, frame, bead].
        spacing: time between the frames, in units of T.
        integrations: as in `_begun`.
    """
    overlap, rate, quickening = states
    strain = overlap - elastic.rest
    gone = dashpot.lets_go(loss, strain, rate) | (overlap <= 0.0)
    force = laws.whole_force(elastic, overlap) + dashpot.damping(loss, strain, rate)
    slope = laws.stiffness(elastic, strain) * rate + dashpot.change(loss, strain, rate, quickening)
    force, slope = (np.where(gone, 0.0, np.abs(values)).max(axis=0) for values in (force, slope * spacing))
    between = gone[0] != gone[1]
    away = np.where(between & (slope > 0.0), force / np.where(slope > 0.0, slope, 1.0), np.inf)
    return np.asarray(spacing * slope * unfollowed(1.0, away, between, integrations))


def _by_yielding(law: Any, overlap: Floats, closing: Floats, spacing: float) -> Floats:
    """Errors as in `kinks` by contacts that yield; the law has their states at both frames.

    They open at the permanent overlap, and their stiffness jumps where unloading begins or first loading continues.
    """
    permanent, turning = law.permanent(*law), laws.turning_overlap(law)
    errors = _by(partial(_of_unloading, law), 0, overlap - permanent, closing, spacing)
    loads = laws.loading(law, overlap, closing)
    ends, goes_on = loads[0] & ~loads[1], loads[1] & ~loads[0]
    up, down = (laws.stiffness(laws.on_branch(law, sign), turning - law.rest) for sign in (1.0, -1.0))
    before, after = np.abs(up - down)
    jump, fastest, turn = np.where(ends, after, before), np.abs(closing).max(axis=0), np.abs(closing[0] - closing[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        since_top = np.nan_to_num(np.abs(closing[1]) / turn)
        since_turning = np.nan_to_num((overlap[1] - turning[0]) / (fastest * spacing))
    jumped = 0.5 * jump * turn * spacing * unfollowed(2.0, np.where(ends, since_top, np.inf), ends)
    jumped += jump * fastest * spacing * unfollowed(1.0, np.where(goes_on, since_turning, np.inf), goes_on)
    return np.asarray(errors + spacing * jumped)


def _of_unloading(law: Any, overlap: Floats, _rate: Floats) -> Forces:
    """Exponent in time and force of contacts that have yielded, as `_of_contacts`; overlap beyond the permanent one.

    The law is that of both frames, and its force that in the states of the second.
    """
    begins = law.permanent(*law)
    small, large = (np.max(laws.whole_force(law, begins + much)[1]) for much in (1e-6, 2e-6))
    if small > 0.0:  # else of walls that none of these beads meets
        yield round(float(np.log2(large / small)), 2), laws.whole_force(law, begins + overlap)[1]


def _of_contacts(law: Any, loss: Any, overlap: Floats, rate: Floats) -> Forces:
    """Exponent in time with which each force of contacts begins, and the force at this overlap and rate, [bead]."""
    power = law.exponent if np.ndim(law.exponent) == 0 else None
    yield power or 1.5, laws.whole_force(law, overlap)
    if loss is not None:
        yield _of_dashpot(replace(loss, rest=0.0), overlap, rate)


def _of_dashpot(law: Any, overlap: Floats, rate: Floats) -> tuple[float, Floats]:
    single, double = (float(np.max(dashpot.resistance(law, np.float64(much)))) for much in (1.0, 2.0))
    power = float(np.log2(double / single)) if single > 0.0 else 0.0
    return power, dashpot.resistance(law, overlap) * rate


def unfollowed(power: float, away: Floats, between: Flags, integrations: int = 0) -> Floats:
    """Errors of velocity, and of its slope, by a force that is ``time**power`` after it begins, [0 or 1, ...].

    Times are in frames. The errors are the largest over the factors of `DOUBT`.

    Args:
        power: exponent of time; 0 for a force that jumps.
        away: [...] distance of the beginning from the frame that sees it; inf where no force begins.
        between: [...] whether the beginning is between the two frames, else before both.
        integrations: number of integrations over time after which the force acts.
    """
    worst = np.zeros((2, *np.shape(away)))
    for factor in DOUBT:
        distance = np.clip(factor * away, NEAREST, None)
        begin = np.where(between, 1.0 - np.minimum(distance, 1.0), -distance)
        grid, *errors = _table(power + integrations)
        for k, error in enumerate(errors):
            worst[k] = np.fmax(worst[k], np.interp(begin, grid, error, left=0.0))
    return MARGIN * worst / math.prod(power + k for k in range(1, integrations + 1))


@lru_cache
def _table(power: float) -> tuple[Floats, Floats, Floats]:
    """Beginnings of forces, in frames, and the errors of velocity and slope by them, each [beginning]."""
    near = np.geomspace(NEAREST, 0.5, 60)
    begin = np.concatenate([-np.geomspace(FARTHEST, NEAREST, 100), near, 1.0 - near[::-1]])

    return begin, *_missed(lambda s: _since(s, begin, power))


def _since(s: float, begin: Floats, power: float) -> Floats:
    """Velocity, force and its rate at a time, of a force that begins as a power, [3, ...]."""
    since = np.maximum(s - begin, 0.0)
    on = s >= begin
    rate = np.where(on & (power > 0.0), power * np.where(since > 0.0, since, 1.0) ** (power - 1.0), 0.0)
    return np.array([since ** (power + 1.0) / (power + 1.0), np.where(on, since**power, 0.0), rate])


def _missed(states: Callable[[float], Floats]) -> Floats:
    """Largest errors of velocity and of its slope by a fit to states at 0 and 1, [0 or 1, ...]."""
    fitted = hermite.coefficients((0, 1), np.array([states(0.0), states(1.0)]), 1.0)
    slope = hermite.derivative(fitted)
    worst = np.zeros((2, *fitted.shape[1:]))
    for s in np.linspace(0.0, 1.0, SAMPLES).tolist():
        at = np.full(fitted.shape[1:], s)
        velocity, force, _ = states(s)
        worst[0] = np.fmax(worst[0], np.abs(hermite.value(fitted, at) - velocity))
        worst[1] = np.fmax(worst[1], np.abs(hermite.value(slope, at) - force))
    return worst
