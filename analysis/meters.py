"""A run in parts of bounded size, and meters: what is computed from each part, and put together at the end.

A part is a block of frames with some frames of its neighbours on either side, enough for whatever lies between two
frames. So what a meter computes from a part depends on that part alone, and no number depends on where parts begin.

Measures of plug-ins have a `Meter`: it says what it takes from each `Part` of a run.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from analysis.trajectory import Trajectory, joined

BEFORE = 2
"""Frames of a part before its own."""

AFTER = 3
"""Frames of a part after its own; with the frame itself four, which fix a maximum where few beads are recorded."""


@dataclass(frozen=True)
class Part:
    """Consecutive frames of a run, with some on either side.

    Attributes:
        around: these frames, `BEFORE` others before and `AFTER` others after them, fewer at the ends of the run, all at
            the beads of these frames; NaN at those that a window has left by then.
        before: number of frames before these.
        count: number of these frames.
        start: number of the first of them in the run, from 0.

    Examples:
        >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
        >>> first, second = parts_of([frames[:100], frames[100:]])
        >>> second.start, second.frames.time[:1].round(1), second.around.time[:1].round(1)  # times in units of T
        (100, array([10.]), array([9.8]))
    """

    around: Trajectory
    before: int
    count: int
    start: int

    @property
    def frames(self) -> Trajectory:
        """The frames of this part alone."""
        return self.around[self.before : self.before + self.count]

    @property
    def is_last(self) -> bool:
        """Whether no frame of the run follows."""
        return self.around.frames == self.before + self.count

    @property
    def to_next(self) -> Trajectory:
        """The frames of this part and the next frame of the run, between which all its instants lie."""
        return self.around[self.before : self.before + self.count + 1]

    def every(self, stride: int) -> slice:
        """Positions among the part's frames of those whose number in the run is a multiple of a stride."""
        return slice(-self.start % stride, None, stride)


def parts_of(blocks: Iterable[Trajectory]) -> Iterator[Part]:
    """Parts of a run, one for each block.

    Args:
        blocks: consecutive frames of a run, from its first on, evenly spaced in time.

    Yields:
        The parts, in order.

    Examples:
        >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
        >>> [(part.start, part.count, part.around.frames) for part in parts_of([frames[:100], frames[100:]])]
        [(0, 100, 103), (100, 201, 203)]
    """
    ahead: list[Trajectory] = []
    before: Trajectory | None = None
    start, stream = 0, (block for block in blocks if block.frames)
    while True:
        while sum(block.frames for block in ahead[1:]) < AFTER and (block := next(stream, None)) is not None:
            ahead.append(block)
        if not ahead:
            return
        block = ahead.pop(0)
        behind = [] if before is None else [before]
        around = _at_beads_of(block, [*behind, block, *(later[:AFTER] for later in ahead)])
        carried = sum(earlier.frames for earlier in behind)
        yield Part(around[: carried + block.frames + AFTER], carried, block.frames, start)
        before = around[: carried + block.frames].last(BEFORE)
        start += block.frames


def _at_beads_of(block: Trajectory, consecutive: list[Trajectory]) -> Trajectory:
    """Consecutive frames in one trajectory, at the beads of a block: a window may have moved."""
    last = block.first + block.velocity.shape[2] - 1
    return joined(frames.on(block.first, last, behind=np.nan) for frames in consecutive)


Piece = TypeVar("Piece")
Result = TypeVar("Result")


class Meter(ABC, Generic[Piece, Result]):
    """What is measured in a run: a function of each part, and one that puts its values together.

    A meter has parameters, but no state.

    Examples:
        >>> class Fastest(Meter):
        ...     "Largest velocity of each bead, [chain, bead] in units of V."
        ...     def of_part(self, part):
        ...         return part.frames.velocity.max(axis=0)
        ...     def result(self, pieces):
        ...         return np.max(pieces, axis=0)
        >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
        >>> Fastest().read(frames.blocks())[0, :3].round(3)
        array([1.   , 0.751, 0.714])
    """

    @abstractmethod
    def of_part(self, part: Part) -> Piece:
        """What the result takes from a part."""

    @abstractmethod
    def result(self, pieces: list[Piece]) -> Result:
        """The result, from what all parts of a run gave, in order."""

    def read(self, blocks: Iterable[Trajectory]) -> Result:
        """The result for a run that is given as consecutive blocks of frames, from its first on.

        Args:
            blocks: consecutive frames.

        Returns:
            The result.

        Raises:
            ValueError: there was no frame.

        Examples:
            >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
            >>> peaks.PeakMeter(first_only=True).read(frames.blocks()).velocity[17:].round(3)  # in units of V
            array([0.682, 0.682, 0.986])
        """
        return self.result([self.of_part(part) for part in _some(parts_of(blocks))])


def measured(meters: Mapping[str, Meter[Any, Any]], blocks: Iterable[Trajectory]) -> dict[str, Any]:
    """Results of meters by their names, in one reading of a run.

    Args:
        meters: by name.
        blocks: consecutive frames of the run, from its first on.

    Raises:
        ValueError: there was no frame.
    """
    pieces: dict[str, list[Any]] = {name: [] for name in meters}
    for part in _some(parts_of(blocks)):
        for name, meter in meters.items():
            pieces[name].append(meter.of_part(part))
    return {name: meter.result(pieces.pop(name)) for name, meter in meters.items()}


def _some(run: Iterator[Part]) -> Iterator[Part]:
    """Parts of a run that has any."""
    part = next(run, None)
    if part is None:
        raise ValueError("no frames to measure")
    yield part
    yield from run
