"""Two streams of blocks of the same run, cut so that each pair holds the same frames."""

from collections.abc import Iterable, Iterator

import numpy as np

from analysis.trajectory import Trajectory


def paired(first: Iterable[Trajectory], second: Iterable[Trajectory]) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Blocks of the two with the same times, until the shorter one ends.

    Raises:
        ValueError: the two do not have the same beads, or their frames differ in time.
    """
    streams = (iter(first), iter(second))
    held: list[Trajectory | None] = [None, None]
    while True:
        for side, stream in enumerate(streams):
            block = held[side]
            if block is None or block.frames == 0:
                held[side] = next(stream, None)
        a, b = held
        if a is None or b is None:
            return
        count = min(a.frames, b.frames)
        held = [a[count:], b[count:]]
        a, b = a[:count], b[:count]
        if a.displacement.shape != b.displacement.shape or not np.array_equal(a.beads, b.beads):
            raise ValueError("the two trajectories have different beads")
        if not np.allclose(a.time, b.time, rtol=1e-9, atol=1e-9):
            raise ValueError(f"the two trajectories have frames at other times, from t = {a.time[0]:.6g} on")
        yield a, b
