"""Every passage of a compressive pulse at a bead: a maximum over time of its velocity, found between the frames.

Where all beads are recorded, the equation of motion gives acceleration and its rate at each frame; velocity and its
first two derivatives at the two frames around a maximum fix a polynomial of degree five, and with displacement one of
degree six. Where only some beads are recorded, that degree comes from displacement and velocity at four frames. Reads a run block by block, so its memory does not grow
with the number of frames.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis import hermite, motion
from analysis.trajectory import Floats, Trajectory, joined

THRESHOLD = 1e-3
"""Smallest maximum that counts as a pulse, in units of V."""

FAR_APART = 0.5
"""Time between frames from which on displacements help to find a maximum, in units of T. Nearer together they harm:
velocity Verlet's velocities differ from the slope of its displacements by ``timestep**2 / 6`` times the jerk.
"""


@dataclass(frozen=True)
class Peaks:
    """Maxima of bead velocity over time, sorted by chain, bead, time; one entry per maximum.

    Attributes:
        chain, bead: counted from 1.
        time: of the maximum, in units of T.
        velocity: the maximum, in units of V; always positive, along ``direction``.
    """

    chain: NDArray[np.int64]
    bead: NDArray[np.int64]
    time: Floats
    velocity: Floats

    def __len__(self) -> int:
        return len(self.time)


class PeakFinder:
    """Finds maxima in a run that is given piece by piece; holds three frames and what it found.

    A bead that starts at its largest velocity (a kicked one) has a maximum at the start. A velocity that reaches a
    level and stays there, as that of a bead that leaves the free end, has its maximum where it reaches it.

    Args:
        threshold: smallest maximum that counts, in units of V.
    """

    def __init__(self, threshold: float = THRESHOLD) -> None:
        self._threshold = threshold
        self._found: list[Peaks] = []
        self._carried: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames, evenly spaced in time with those before."""
        if self._carried is None:
            self._found.append(_at_start(block, self._threshold))
            self._carried = block
        else:
            self._carried = joined([self._carried, block])
        self._found.append(_inside(self._carried, self._threshold, 1, self._carried.frames - 2))
        self._carried = self._carried[-3:]

    def result(self) -> Peaks:
        """The maxima of all frames so far.

        Raises:
            ValueError: there was no frame.
        """
        if self._carried is None:
            raise ValueError("no frames to analyse")
        frames = self._carried.frames
        return _sorted([*self._found, _inside(self._carried, self._threshold, frames - 2, frames - 1)])


def find_peaks(blocks: Iterable[Trajectory], threshold: float = THRESHOLD) -> Peaks:
    """Maxima above a threshold in a run given as consecutive blocks of frames; see `PeakFinder`."""
    finder = PeakFinder(threshold)
    for block in blocks:
        finder.add(block)
    return finder.result()


def _inside(block: Trajectory, threshold: float, low: int, high: int) -> Peaks:
    """Maxima whose largest frame is one of ``low`` to ``high - 1``, all of which have a frame on either side."""
    if not 1 <= low < high:
        return _none()
    v = block.velocity
    middle = v[low:high]
    is_peak = (middle > threshold) & (v[low - 1 : high - 1] < middle) & (middle >= v[low + 1 : high + 1])
    frame, chain, bead = (index.astype(np.int64) for index in np.nonzero(is_peak))
    frame += low
    if len(frame) == 0:
        return _none()
    time, velocity = _refined(block, frame, chain, bead)
    return Peaks(chain + 1, block.beads[bead], time, velocity)


def _refined(
    block: Trajectory, frame: NDArray[np.int64], chain: NDArray[np.int64], bead: NDArray[np.int64]
) -> tuple[Floats, Floats]:
    """Time and height of the maxima whose largest frames are given."""
    spacing = float(block.time[1] - block.time[0])
    x, v = block.displacement, block.velocity
    if block.problem.recorded is None:
        rising = motion.acceleration_and_rate(block, frame, chain, bead)[0] > 0.0
        start = np.where(rising, frame, frame - 1)
        nodes: tuple[int, ...] = (0, 1)
        low, high = np.zeros(len(frame)), np.ones(len(frame))
    else:
        nodes = tuple(range(min(4, block.frames)))
        start = np.clip(frame - 1, 0, block.frames - len(nodes))
        low = (frame - start - 1).astype(float)
        high = low + 2.0
    states = []
    for at in (start + node for node in nodes):
        state = [x[at, chain, bead], v[at, chain, bead]]
        if block.problem.recorded is None:
            state += motion.acceleration_and_rate(block, at, chain, bead)
        states.append(state)
    data = np.array(states)
    if block.problem.recorded is None and spacing < FAR_APART:
        speed = hermite.coefficients(nodes, data[:, 1:], spacing)
    else:
        speed = hermite.derivative(hermite.coefficients(nodes, data, spacing)) / spacing
    at = hermite.falling_zero(hermite.derivative(speed), low, high)
    return block.time[start] + at * spacing, hermite.value(speed, at)


def _at_start(block: Trajectory, threshold: float) -> Peaks:
    if block.frames < 2:
        return _none()
    v = block.velocity
    chain, bead = np.nonzero((v[0] > threshold) & (v[0] >= v[1]))
    return Peaks(chain + 1, block.beads[bead], np.full(len(chain), block.time[0]), v[0, chain, bead])


def _none() -> Peaks:
    empty = np.zeros(0, dtype=np.int64)
    return Peaks(empty, empty, np.zeros(0), np.zeros(0))


def _sorted(parts: list[Peaks]) -> Peaks:
    chain = np.concatenate([part.chain for part in parts])
    bead = np.concatenate([part.bead for part in parts])
    time = np.concatenate([part.time for part in parts])
    velocity = np.concatenate([part.velocity for part in parts])
    order = np.lexsort((time, bead, chain))
    return Peaks(chain[order], bead[order], time[order], velocity[order])
