"""Every passage of a compressive pulse at a bead: a maximum over time of its velocity, found between the frames.

`peak_bounds` has the place between the frames, and its uncertainty.

Plug-ins take this module for maxima of velocity: a `PeakMeter` gives the `Peaks` of a run; `sharp` says which of them
have a defined time.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> maxima = peaks.PeakMeter().read(frames.blocks())
    >>> maxima.bead[8:10], maxima.velocity[8:10].round(4), maxima.time[8:10].round(2)  # in units of V and T
    (array([ 9, 10]), array([0.6825, 0.6821]), array([10.29, 11.48]))
    >>> peaks.sharp(maxima)[-2:]  # the last bead flies off: the time of its largest velocity is undefined
    array([ True, False])
"""

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any

import numpy as np

from analysis import hermite, motion
from analysis.columns import Columns, together
from analysis.meters import Meter, Part
from analysis.tracking.crossings import candidates
from analysis.tracking.peak_bounds import (
    Brackets,
    between_pairs,
    bracketed,
    no_maxima,
    on_a_grid,
    places_of,
    quickness_of,
)
from analysis.trajectory import Flags, Floats, Integers, Trajectory

THRESHOLD = 1e-3
"""Smallest maximum that counts as a pulse, in units of V."""

SPARSE = 0.7
"""Time between frames, in the time scale of the fastest motion, beyond which maxima may be hidden anywhere."""


@dataclass(frozen=True)
class Peaks(Columns):
    """Maxima of bead velocity over time, sorted by chain, bead, time; one entry per maximum.

    Attributes:
        chain, bead: counted from 1.
        time: of the maximum, in units of T.
        velocity: the maximum along ``direction``, in units of V; always positive.
        pressing: force of a contact of the bead times its overlap, over the bead's mass, the larger of two, at the
            nearest frame, in units of V squared; negative where neighbours are apart; NaN where not all are recorded.
        centre: centre in time of all the impulse that the bead was given until then, in units of T. It is ``time - x /
            velocity`` with the displacement x at the maximum, which hardly depends on ``time``: also where a bead flies
            on at its largest velocity, it is sharp.
        time_error, velocity_error, centre_error: how far these may be off because of the time between frames; the time
            of a bead that flies freely is not known at all (inf), see `sharp`.
        direction: of the velocities: 1 towards higher bead numbers, -1 towards lower ones.
    """

    chain: Integers
    bead: Integers
    time: Floats
    velocity: Floats
    pressing: Floats
    centre: Floats
    time_error: Floats
    velocity_error: Floats
    centre_error: Floats
    direction: int = 1

    def first(self) -> "Peaks":
        """The first maximum of each bead."""
        new = np.ones(len(self), dtype=bool)
        new[1:] = (self.chain[1:] != self.chain[:-1]) | (self.bead[1:] != self.bead[:-1])
        return self.where(new)


FREE = 0.05**2.5
"""Pressing at its peak, over the velocity squared, below which a bead is taken for one that flies freely (the exact
solitary wave of spheres has ``0.66**2.5``). Such a velocity reaches a level and stays: the time of its maximum is
undefined.
"""


def sharp(peaks: Peaks) -> Flags:
    """Mask, [maximum], of passages of defined time: all but those of beads that fly freely, as far as that is known."""
    return ~(peaks.pressing < FREE * peaks.velocity**2)


Places = tuple[Integers, Integers, Integers]
"""Positions of frames, chains and beads in a block, each [entry]."""


@dataclass(frozen=True)
class PeakMeter(Meter[Brackets, Peaks]):
    """Maxima above a threshold.

    A bead that starts at its largest velocity (a kicked one) has a maximum at the start. A velocity that reaches a
    level and stays there, as that of a bead that leaves the free end, has its maximum where it reaches it.

    Attributes:
        threshold: smallest maximum that counts, in units of V.
        first_only: whether only the first maximum of each bead is wanted, which is several times faster.
        direction: 1 for velocities towards higher bead numbers, -1 towards lower ones; None for the way of the largest
            kick.
    """

    threshold: float = THRESHOLD
    _: KW_ONLY
    first_only: bool = False
    direction: int | None = None

    def of_part(self, part: Part) -> Brackets:
        """Brackets of the maxima at a frame of the part, or between it and the next."""
        block = part.around
        direction = block.problem.direction if self.direction is None else self.direction
        frame, chain, bead = (self._between if block.forces_known else self._at)(part, direction)
        if len(frame) == 0:
            return no_maxima(direction)
        if not block.forces_known:
            return bracketed(block, frame, chain, bead, direction)
        return between_pairs(block, frame, chain, bead, direction, self.threshold)

    def _at(self, part: Part, direction: int) -> Places:
        """Largest frames of maxima, of recorded beads alone."""
        block = part.around
        v = direction * block.velocity
        low, high = max(1, part.before), min(part.before + part.count, block.frames - 1)
        is_peak = (v[low:high] > self.threshold) & (v[low - 1 : high - 1] < v[low:high])
        is_peak &= v[low:high] >= v[low + 1 : high + 1]
        frame, chain, bead = (index.astype(np.int64) for index in np.nonzero(is_peak))
        if part.start == 0 and block.frames > 1:
            kicked = np.nonzero((v[0] > self.threshold) & (v[0] >= v[1]))
            return _first_frame(kicked, (frame + low, chain, bead))
        return frame + low, chain, bead

    def _between(self, part: Part, direction: int) -> Places:
        """First frames of pairs between which there may be maxima."""
        block = part.around
        moving = block.moving
        v = direction * block.velocity[:, :, moving]
        low, high = max(1, part.before), min(part.before + part.count, block.frames - 1)
        around = v[low - 1 : high + 2]
        if len(around) < high - low + 3:
            around = np.concatenate([around, v[-1:]])
        follow = block.problem.rows.follow
        everywhere = block.problem.every * quickness_of(block.problem.system) > SPARSE
        around = np.nan_to_num(around) if follow else around
        (frame, chain, bead), falls = candidates(around, self.threshold, everywhere=everywhere)
        frame += low
        chosen = ~falls
        chosen[falls] = ~_slows(block, frame[falls], chain[falls], bead[falls] + moving.start, direction)
        if self.first_only:  # none after the first largest frame
            at = v[frame, chain, bead]
            largest = falls & (at > self.threshold) & (at > v[frame - 1, chain, bead])
            last = np.full(v.shape[1:], block.frames)
            np.minimum.at(last, (chain[largest], bead[largest]), frame[largest])
            chosen &= frame <= last[chain, bead]
        if follow:  # what the window has left by the next frame, and the bead ahead of that, which lacks a neighbour
            chosen &= ~np.isnan(v[frame + 1, chain, np.maximum(bead - 1, 0)])
        frame, chain, bead = frame[chosen], chain[chosen], bead[chosen] + moving.start
        if part.start > 0 or block.frames < 2:
            return frame, chain, bead
        fast = v[0] > self.threshold
        if len(v) > 2:
            (_, *places), _ = candidates(np.concatenate([v[:1], v[:3]]), self.threshold, everywhere=everywhere)
            fast[tuple(places)] = True
        chains, beads = np.nonzero(fast)
        return _first_frame((chains, beads + moving.start), (frame, chain, bead))

    def result(self, pieces: list[Brackets]) -> Peaks:
        """The maxima, sorted."""
        brackets = together(pieces)
        return _refined(brackets.where(brackets.first_certain()) if self.first_only else brackets)


def _first_frame(first: tuple[Any, ...], later: Places) -> Places:
    """Chains and beads at frame 0, and those of later frames."""
    frame, chain, bead = later
    nothing = np.zeros(len(first[0]), dtype=np.int64)
    return np.concatenate([nothing, frame]), np.concatenate([first[0], chain]), np.concatenate([first[1], bead])


def _slows(block: Trajectory, frame: Integers, chain: Integers, bead: Integers, direction: int) -> Flags:
    """Whether beads are slower after frames, [entry] positions in a block whose frames determine the forces."""
    return np.asarray(direction * motion.acceleration_and_rate(block, frame, chain, bead)[0] <= 0.0)


def find_peaks(blocks: Iterable[Trajectory], threshold: float = THRESHOLD, *, direction: int | None = None) -> Peaks:
    """Maxima above a threshold in a run given as consecutive blocks of frames; see `PeakMeter`."""
    return PeakMeter(threshold, direction=direction).read(blocks)


def _refined(brackets: Brackets) -> Peaks:
    early, at, late = places_of(brackets)
    off, spacing = brackets.off, brackets.spacing

    def passage(s: Floats) -> tuple[Floats, Floats, Floats]:
        """Velocity, time, and centre of the impulse until places [maximum] between frames, in units of V and T."""
        velocity, time = hermite.value(brackets.velocity, s), brackets.origin + s * spacing
        displacement = brackets.displacement + spacing * hermite.integral(brackets.velocity, s)
        return velocity, time, time - displacement / velocity

    velocity, time, centre = passage(at)
    velocity_before, _, centre_before = passage(early)
    frames = spacing * brackets.slowness
    exact_time, exact_velocity = np.where(
        brackets.forces_known, on_a_grid(frames, velocity), on_a_grid(frames, velocity, all_recorded=False)
    )
    doubt = off[0] + exact_velocity
    later = brackets.places[1, 0] < brackets.places[1, 1]  # else at the start, which is exact
    time_error = later * (np.maximum(at - early, late - at) * spacing + exact_time / brackets.slowness)
    velocity_error = later * (doubt + np.abs(velocity - velocity_before))
    in_centre = (spacing + np.abs(time - centre)) * doubt / velocity
    centre_error = later * (in_centre + np.abs(centre - centre_before))
    peaks = Peaks(
        chain=brackets.chain,
        bead=brackets.bead,
        time=time,
        velocity=velocity,
        pressing=brackets.pressing,
        centre=centre,
        time_error=time_error,
        velocity_error=velocity_error,
        centre_error=centre_error,
        direction=brackets.direction,
    )
    order = np.lexsort((time, brackets.bead, brackets.chain))
    peaks = _that_exist(peaks.where(order), brackets.certain[order])
    return replace(peaks, time_error=np.where(sharp(peaks) | (peaks.time_error == 0.0), peaks.time_error, np.inf))


def _that_exist(peaks: Peaks, certain: Flags) -> Peaks:
    """The certain ones of maxima in order; the errors of each cover those just before it that may be none."""
    position = np.arange(len(peaks))
    follows = np.minimum.accumulate(np.where(certain, position, len(peaks))[::-1])[::-1]
    at = np.flatnonzero(~certain & (follows < len(peaks)))
    after = follows[at]
    same = (peaks.chain[at] == peaks.chain[after]) & (peaks.bead[at] == peaks.bead[after])
    at, after = at[same], after[same]
    errors = {}
    for name in ("time", "velocity", "centre"):
        value, error = getattr(peaks, name), getattr(peaks, f"{name}_error").copy()
        np.maximum.at(error, after, np.abs(value[after] - value[at]) + error[at] + error[after])
        errors[f"{name}_error"] = error
    return replace(peaks, **errors).where(certain)
