"""Two streams of blocks of the same run, cut so that each pair holds the same frames."""

from collections.abc import Iterable, Iterator

import numpy as np

from analysis.trajectory import Trajectory
from lammps_inputs import InputError


class OtherFramesError(InputError):
    """Two trajectories that do not have the same beads and times."""


def on_common_rows(*blocks: Trajectory) -> tuple[Trajectory, ...]:
    """The rows that all hold, where windows follow the pulse; else all as they are."""
    if blocks[0].problem.window is None:
        return blocks
    first, last = max(int(block.beads[0]) for block in blocks), min(int(block.beads[-1]) for block in blocks)
    return tuple(block.on(first, last) for block in blocks)


def near_the_front(block: Trajectory) -> Trajectory:
    """The half of a window's rows that is nearer to its head; all rows before any was left behind, or without a window.

    Rows near the tail lack what they would get from those left behind. That spreads into the window more slowly than
    the window moves on.
    """
    window = block.problem.window
    if window is None or block.first == 1:
        return block
    head = int(block.beads[-1])
    return block.on(head - window // 2 + 1, head)


def paired(first: Iterable[Trajectory], second: Iterable[Trajectory]) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Blocks of the two with the same times, until the shorter one ends.

    Raises:
        OtherFramesError: the two do not have the same beads, or their frames differ in time.
    """
    streams = (iter(first), iter(second))
    held: list[Trajectory | None] = [None, None]
    while True:
        for side, stream in enumerate(streams):
            while (block := held[side]) is None or block.frames == 0:
                held[side] = next(stream, None)
                if held[side] is None:
                    return
        a, b = held
        assert a is not None
        assert b is not None
        count = min(a.frames, b.frames)
        held = [a[count:], b[count:]]
        a, b = on_common_rows(near_the_front(a[:count]), b[:count])
        if a.displacement.shape != b.displacement.shape or not np.array_equal(a.beads, b.beads):
            raise OtherFramesError("the two trajectories have different beads")
        if not np.allclose(a.time, b.time, rtol=1e-9, atol=1e-9):
            k = int(np.argmin(np.isclose(a.time, b.time, rtol=1e-9, atol=1e-9)))
            raise OtherFramesError(
                f"a frame is at t = {a.time[k]:.9g} (dimensionless), where {b.time[k]:.9g} is expected"
            )
        yield a, b
