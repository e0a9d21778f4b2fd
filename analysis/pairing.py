"""Two streams of blocks of the same run, cut so that each pair holds the same frames."""

from collections.abc import Iterable, Iterator

import numpy as np

from analysis.trajectory import Trajectory
from lammps_inputs import InputError


class OtherFramesError(InputError):
    """Two trajectories that do not have the same beads and times."""


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
        a, b = a[:count], b[:count]
        if a.displacement.shape != b.displacement.shape or not np.array_equal(a.beads, b.beads):
            raise OtherFramesError("the two trajectories have different beads")
        if not np.allclose(a.time, b.time, rtol=1e-9, atol=1e-9):
            k = int(np.argmin(np.isclose(a.time, b.time, rtol=1e-9, atol=1e-9)))
            raise OtherFramesError(
                f"a frame is at t = {a.time[k]:.9g} (dimensionless), where {b.time[k]:.9g} is expected"
            )
        yield a, b
