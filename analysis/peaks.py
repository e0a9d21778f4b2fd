"""Every passage of a compressive pulse at a bead: a maximum over time of its velocity, found between the frames.

Where all beads are recorded, the equation of motion gives acceleration and its rate at each frame; velocity and its
first two derivatives at the two frames around a maximum fix a polynomial of degree five, and with displacement one of
degree six. Where only some beads are recorded, that degree comes from displacement and velocity at four frames; where
the record is noisy, degree three from velocity alone. Reads a run block by block, so its memory does not grow with the
number of frames.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis import hermite, motion
from analysis.solitary_wave import solitary_wave
from analysis.trajectory import Floats, Trajectory, joined
from lammps_inputs import Problem

Integers = NDArray[np.int64]

THRESHOLD = 1e-3
"""Smallest maximum that counts as a pulse, in units of V."""

FAR_APART = 0.5
"""Time between frames from which on displacements help to find a maximum, in units of T. Nearer together they harm:
velocity Verlet's velocities differ from the slope of its displacements by ``timestep**2 / 6`` times the jerk.
"""


APART = 1.5
"""Least distance of two maxima of a noisy record, in passages of the higher wave: its foot ends there."""


@dataclass(frozen=True)
class Peaks:
    """Maxima of bead velocity over time, sorted by chain, bead, time; one entry per maximum.

    Attributes:
        chain, bead: counted from 1.
        time: of the maximum, in units of T.
        velocity: the maximum, in units of V; always positive.
        overlap: the bead's larger overlap with a neighbour at the nearest frame, in units of L, negative where both
            are apart; NaN where not all beads are recorded.
    """

    chain: NDArray[np.int64]
    bead: NDArray[np.int64]
    time: Floats
    velocity: Floats
    overlap: Floats

    def where(self, chosen: NDArray[np.bool_]) -> "Peaks":
        """The maxima that a mask chooses."""
        return Peaks(
            self.chain[chosen], self.bead[chosen], self.time[chosen], self.velocity[chosen], self.overlap[chosen]
        )

    def __len__(self) -> int:
        return len(self.time)


class PeakFinder:
    """Finds maxima in a run that is given piece by piece; holds three frames and what it found.

    A bead that starts at its largest velocity (a kicked one) has a maximum at the start. A velocity that reaches a
    level and stays there, as that of a bead that leaves the free end, has its maximum where it reaches it.

    Args:
        threshold: smallest maximum that counts, in units of V.
        first_only: whether only the first maximum of each bead is wanted, which is several times faster.
        noisy: whether the states do not obey the equation of motion, so that velocities alone are used.
    """

    def __init__(self, threshold: float = THRESHOLD, *, first_only: bool = False, noisy: bool = False) -> None:
        self._threshold = threshold
        self._noisy = noisy
        self._found: list[_Brackets] = []
        self._carried: Trajectory | None = None
        self._first_only = first_only
        self._passed: NDArray[np.bool_] | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        if self._carried is not None:  # a window may have moved on
            self._carried = self._carried.on(block.first, block.first + block.velocity.shape[2] - 1)
        if self._carried is None:
            if block.frames > 1:
                self._keep(block, *_at_start(block, self._threshold))
            self._search(block, block.frames - 2)
            self._carried = block[-3:]
        elif self._carried.frames < 3 or block.frames < 3:
            started = self._carried.frames == 1
            edge = joined([self._carried, block])
            if started:
                self._keep(edge, *_at_start(edge, self._threshold))
            self._search(edge, edge.frames - 2)
            self._carried = edge[-3:]
        else:
            self._search(joined([self._carried, block[:3]]), 4)
            self._search(block, block.frames - 2)
            self._carried = block[-3:]

    def result(self) -> Peaks:
        """The maxima of all frames so far; no frame may be added afterwards.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None:
            raise ValueError("no frames to analyse")
        self._search(self._carried, self._carried.frames - 1, low=self._carried.frames - 2)
        return _refined(self._found)

    def state(self) -> dict[str, NDArray[Any]]:
        """What `resumed` needs to go on later with the frames that follow, as arrays.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None:
            raise ValueError("no frames to go on from")
        found = _together(self._found)
        return {
            **{f"found_{field.name}": getattr(found, field.name) for field in fields(_Brackets)},
            "time": self._carried.time,
            "displacement": self._carried.displacement,
            "velocity": self._carried.velocity,
            "first": np.array(self._carried.first),
            "passed": np.zeros((0, 0), dtype=bool) if self._passed is None else self._passed,
        }

    def resumed(self, problem: Problem, state: Mapping[str, NDArray[Any]]) -> "PeakFinder":
        """Go on, still unused, where another was when it gave its `state`."""
        self._found = [_Brackets(**{field.name: state[f"found_{field.name}"] for field in fields(_Brackets)})]
        self._carried = Trajectory(
            problem, state["time"], state["displacement"], state["velocity"], first=int(state["first"])
        )
        self._passed = state["passed"] if state["passed"].size else None
        return self

    def _search(self, block: Trajectory, high: int, low: int = 1) -> None:
        """Maxima whose largest frame is one of ``low`` to ``high - 1``, all of which have a frame on either side."""
        if not 1 <= low < high:
            return
        moving = block.moving
        v = block.velocity[:, :, moving]
        middle = v[low:high]
        is_peak = (middle > self._threshold) & (v[low - 1 : high - 1] < middle) & (middle >= v[low + 1 : high + 1])
        frame, chain, bead = (index.astype(np.int64) for index in np.nonzero(is_peak))
        self._keep(block, frame + low, chain, bead + moving.start)

    def _keep(self, block: Trajectory, frame: Integers, chain: Integers, bead: Integers) -> None:
        """Add the maxima whose largest frames are given, in the order of time."""
        if self._first_only:
            if self._passed is None:
                self._passed = np.zeros((block.problem.chains, len(block.problem.recorded_beads)), dtype=bool)
            place = chain * self._passed.shape[1] + bead + block.first - 1
            _, first = np.unique(place, return_index=True)
            first = first[~self._passed.flat[place[first]]]
            frame, chain, bead = frame[first], chain[first], bead[first]
            self._passed.flat[place[first]] = True
        if len(frame) == 0:
            return
        self._found.append(_bracketed(block, frame, chain, bead, self._noisy))


def find_peaks(blocks: Iterable[Trajectory], threshold: float = THRESHOLD) -> Peaks:
    """Maxima above a threshold in a run given as consecutive blocks of frames; see `PeakFinder`."""
    finder = PeakFinder(threshold)
    for block in blocks:
        finder.add(block)
    return finder.result()


def distinct(peaks: Peaks) -> Peaks:
    """The maxima of a noisy record without those that belong to one passage.

    Left out is whatever is nearer to a higher maximum of its bead than `APART` times the time in which the exact wave
    of that height passes at half its height.
    """
    exact = solitary_wave()
    while len(peaks) > 1:
        near = APART * exact.width / exact.speed_at(peaks.velocity)
        same = (np.diff(peaks.chain) == 0) & (np.diff(peaks.bead) == 0)
        first_higher = peaks.velocity[:-1] >= peaks.velocity[1:]
        merged = same & (np.diff(peaks.time) < np.where(first_higher, near[:-1], near[1:]))
        if not np.any(merged):
            break
        lower = np.zeros(len(peaks), dtype=bool)
        lower[1:] |= merged & first_higher
        lower[:-1] |= merged & ~first_higher
        peaks = peaks.where(~lower)
    return peaks


@dataclass(frozen=True)
class _Brackets:
    """Maxima between frames: a polynomial of velocity for each, and the piece of it where the maximum lies."""

    chain: Integers
    bead: Integers
    origin: Floats
    spacing: Floats
    low: Floats
    high: Floats
    overlap: Floats
    velocity: Floats
    """[power, maximum] in s = (time - origin) / spacing."""


def _bracketed(block: Trajectory, frame: Integers, chain: Integers, bead: Integers, noisy: bool) -> _Brackets:
    """Maxima whose largest frames are given. One at frame 0 stays there."""
    spacing = float(block.time[1] - block.time[0])
    x, v = block.displacement, block.velocity
    by_equations = block.problem.recorded is None and not noisy
    if by_equations:
        rising = motion.acceleration_and_rate(block, frame, chain, bead)[0] > 0.0
        start = np.maximum(np.where(rising, frame, frame - 1), 0)
        nodes: tuple[int, ...] = (0, 1)
        low, high = np.zeros(len(frame)), np.ones(len(frame))
    else:
        nodes = tuple(range(min(4, block.frames)))
        start = np.clip(frame - 1, 0, block.frames - len(nodes))
        low = np.maximum(frame - start - 1.0, 0.0)
        high = low + 2.0
    states = []
    for at in (start + node for node in nodes):
        state = [x[at, chain, bead], v[at, chain, bead]]
        if by_equations:
            state += motion.acceleration_and_rate(block, at, chain, bead)
        states.append(state)
    data = np.array(states)
    if (noisy or by_equations) and spacing < FAR_APART:
        velocity = hermite.coefficients(nodes, data[:, 1:], spacing)
    else:
        velocity = hermite.derivative(hermite.coefficients(nodes, data, spacing)) / spacing
    velocity = np.concatenate([velocity, np.zeros((_POWERS - len(velocity), len(frame)))])
    high = np.where(frame == 0, low, high)
    number = block.beads[bead]
    overlap = motion.larger_overlap(block, frame, chain, bead)
    return _Brackets(chain + 1, number, block.time[start], np.full(len(frame), spacing), low, high, overlap, velocity)


_POWERS = 7


def _at_start(block: Trajectory, threshold: float) -> tuple[Integers, Integers, Integers]:
    """(frame, chain, bead) of the beads that are fastest at the start."""
    v = block.velocity
    chain, bead = np.nonzero((v[0] > threshold) & (v[0] >= v[1]))
    return np.zeros(len(chain), dtype=np.int64), chain, bead


def _together(parts: list[_Brackets]) -> _Brackets:
    if not parts:
        none = np.zeros(0, dtype=np.int64)
        empty = np.zeros(0)
        return _Brackets(none, none, empty, empty, empty, empty, empty, np.zeros((_POWERS, 0)))
    columns = {field.name: [getattr(part, field.name) for part in parts] for field in fields(_Brackets)}
    return _Brackets(**{name: np.concatenate(column, axis=-1) for name, column in columns.items()})


def _refined(parts: list[_Brackets]) -> Peaks:
    found = _together(parts)
    at = hermite.falling_zero(hermite.derivative(found.velocity), found.low, found.high)
    time, velocity = found.origin + at * found.spacing, hermite.value(found.velocity, at)
    order = np.lexsort((time, found.bead, found.chain))
    return Peaks(found.chain[order], found.bead[order], time[order], velocity[order], found.overlap[order])
