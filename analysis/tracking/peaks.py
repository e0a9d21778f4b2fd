"""Every passage of a compressive pulse at a bead: a maximum over time of its velocity, found between the frames.

`peak_bounds` has the place between the frames, and its uncertainty. A run is read block by block, so memory does not
grow with the number of frames; no number depends on where the blocks begin.

Plug-ins take this module for maxima of velocity: a `PeakFinder` is shown a run and gives its `Peaks`; `sharp` says
which of them have a defined time.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> maxima = watch(peaks.PeakFinder(), frames.blocks()).result()
    >>> maxima.bead[8:10], maxima.velocity[8:10].round(4), maxima.time[8:10].round(2)  # in units of V and T
    (array([ 9, 10]), array([0.6825, 0.6821]), array([10.29, 11.48]))
    >>> peaks.sharp(maxima)[-2:]  # the last bead flies off: the time of its largest velocity is undefined
    array([ True, False])
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from analysis import hermite
from analysis.columns import Columns, together
from analysis.tracking.peak_bounds import NODES, Brackets, bracketed, highest, largest, no_maxima, on_a_grid
from analysis.trajectory import (
    Flags,
    Floats,
    Integers,
    Trajectory,
    joined,
    mirrored_bead,
    watch,
)
from lammps_inputs import Problem

THRESHOLD = 1e-3
"""Smallest maximum that counts as a pulse, in units of V."""


@dataclass(frozen=True)
class Peaks(Columns):
    """Maxima of bead velocity over time, sorted by chain, bead, time; one entry per maximum.

    Attributes:
        chain, bead: counted from 1.
        time: of the maximum, in units of T.
        velocity: the maximum along ``direction``, in units of V; always positive.
        overlap: the bead's larger overlap with a neighbour at the nearest frame, in units of L, negative where both
            are apart; NaN where not all beads are recorded.
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
    overlap: Floats
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


FREE = 0.05
"""Overlap at its peak, over velocity**0.8, below which a bead is taken for one that flies freely (the exact solitary
wave has 0.66). Such a velocity reaches a level and stays: the time of its maximum is undefined.
"""


def sharp(peaks: Peaks) -> Flags:
    """Mask, [maximum], of passages of defined time: all but those of beads that fly freely, as far as that is known."""
    return ~(peaks.overlap < FREE * peaks.velocity**0.8)


def in_mirror(peaks: Peaks, problem: Problem) -> Peaks:
    """Maxima with beads and direction as in the mirror; mirrored twice, the maxima themselves."""
    bead = mirrored_bead(problem, peaks.bead)
    order = np.lexsort((peaks.time, bead, peaks.chain))
    return replace(peaks, bead=bead, direction=-peaks.direction).where(order)


class PeakFinder:
    """Finds maxima in a run that is given piece by piece; holds three frames and what it found.

    A bead that starts at its largest velocity (a kicked one) has a maximum at the start. A velocity that reaches a
    level and stays there, as that of a bead that leaves the free end, has its maximum where it reaches it.

    Args:
        threshold: smallest maximum that counts, in units of V.
        first_only: whether only the first maximum of each bead is wanted, which is several times faster.
        direction: 1 for velocities towards higher bead numbers, -1 towards lower ones; None for the way of the largest
            kick.
    """

    def __init__(
        self,
        threshold: float = THRESHOLD,
        *,
        first_only: bool = False,
        direction: int | None = None,
    ) -> None:
        self._threshold = threshold
        self._direction = direction
        self._brackets = [no_maxima()]
        self._carried: Trajectory | None = None
        self._started = False
        self._first_only = first_only
        self._passed: Flags | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        if self._carried is not None:  # a window may have moved on
            self._carried = self._carried.on(block.first, block.first + block.velocity.shape[2] - 1)
            block = joined([self._carried, block])
        if not self._started and block.frames >= len(NODES):
            self._start(block)
        if self._started:
            self._search(block, block.frames - 2)
        self._carried = block[-3:] if self._started else block

    def result(self) -> Peaks:
        """The maxima of all frames so far; no frame may be added afterwards.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None:
            raise ValueError("no frames to analyse")
        if not self._started:
            self._start(self._carried)
        self._search(self._carried, self._carried.frames - 1, low=self._carried.frames - 2)
        return _refined(self._brackets, self._way(self._carried))

    def forget(self) -> None:
        """Forget what was found but not where the frames ended, so that only what follows is found."""
        self._brackets = [no_maxima()]

    def take_over(self, later: "PeakFinder") -> None:
        """Add the maxima that another finder has found since its `forget`, and continue after its frames."""
        self._brackets += later._brackets
        self._carried = later._carried

    def _way(self, block: Trajectory) -> int:
        return block.problem.direction if self._direction is None else self._direction

    def _start(self, block: Trajectory) -> None:
        """The beads that are fastest at the start."""
        self._started = True
        if block.frames > 1:
            v = self._way(block) * block.velocity[:2]
            chain, bead = np.nonzero((v[0] > self._threshold) & (v[0] >= v[1]))
            self._keep(block, np.zeros(len(chain), dtype=np.int64), chain, bead)

    def _search(self, block: Trajectory, high: int, low: int = 1) -> None:
        """Maxima whose largest frame is one of ``low`` to ``high - 1``, all of which have a frame on either side."""
        if not 1 <= low < high:
            return
        moving = block.moving
        v = block.velocity[:, :, moving] if self._way(block) > 0 else -block.velocity[:, :, moving]
        middle = v[low:high]
        is_peak = (middle > self._threshold) & (v[low - 1 : high - 1] < middle) & (middle >= v[low + 1 : high + 1])
        frame, chain, bead = (index.astype(np.int64) for index in np.nonzero(is_peak))
        self._keep(block, frame + low, chain, bead + moving.start)

    def _keep(self, block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> None:
        """Add the maxima whose largest frames are given, in the order of time."""
        if self._first_only:
            if self._passed is None:
                self._passed = np.zeros((block.problem.chains, len(block.problem.rows.numbers)), dtype=bool)
            place = chain * self._passed.shape[1] + bead + block.first - 1
            _, first = np.unique(place, return_index=True)
            first = first[~self._passed.flat[place[first]]]
            frame, chain, bead = frame[first], chain[first], bead[first]
            self._passed.flat[place[first]] = True
        if len(frame) == 0:
            return
        self._brackets.append(bracketed(block, frame, chain, bead, self._way(block)))


def find_peaks(blocks: Iterable[Trajectory], threshold: float = THRESHOLD, *, direction: int | None = None) -> Peaks:
    """Maxima above a threshold in a run given as consecutive blocks of frames; see `PeakFinder`."""
    return watch(PeakFinder(threshold, direction=direction), blocks).result()


def _refined(parts: list[Brackets], direction: int) -> Peaks:
    brackets = together(parts)
    at, slope = highest(brackets), hermite.derivative(brackets.velocity)
    time, velocity = brackets.origin + at * brackets.spacing, hermite.value(brackets.velocity, at)
    displacement = brackets.displacement + brackets.spacing * hermite.integral(brackets.velocity, at)
    doubt = largest(brackets.doubt, brackets) + brackets.kink[0]
    curvature = -hermite.value(hermite.derivative(slope), at)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope_error = largest(hermite.derivative(brackets.doubt), brackets) + brackets.kink[1]
        time_error = slope_error / curvature * brackets.spacing
    exact_time, exact_velocity = np.where(
        brackets.forces_known,
        on_a_grid(brackets.spacing, velocity),
        on_a_grid(brackets.spacing, velocity, all_recorded=False),
    )
    doubt, time_error = doubt + exact_velocity, time_error + exact_time
    at_start = brackets.low == brackets.high
    # the maximum may be on the other side of the largest frame, where the velocity may exceed what was found
    frames = np.maximum(*(hermite.value(brackets.velocity, end) for end in (brackets.low, brackets.high)))
    more = np.where(brackets.beside > 0.0, np.maximum(brackets.beside + frames - velocity, 0.0), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        time_error = time_error + np.where(
            more > 0.0, np.sqrt(2.0 * more / np.maximum(curvature, 0.0)) * brackets.spacing, 0.0
        )
    doubt = np.maximum(doubt, more)
    time_error = np.where(at_start, 0.0, np.where(time_error >= 0.0, time_error, np.inf))
    peaks = Peaks(
        chain=brackets.chain,
        bead=brackets.bead,
        time=time,
        velocity=velocity,
        overlap=brackets.overlap,
        centre=time - displacement / velocity,
        time_error=time_error,
        velocity_error=np.where(at_start, 0.0, doubt),
        centre_error=np.where(at_start, 0.0, (brackets.spacing + np.abs(displacement / velocity)) * doubt / velocity),
        direction=direction,
    )
    peaks = replace(peaks, time_error=np.where(sharp(peaks) | at_start, time_error, np.inf))
    return peaks.where(np.lexsort((time, brackets.bead, brackets.chain)))
