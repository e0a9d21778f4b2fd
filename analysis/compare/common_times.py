"""Two trajectories at the same times: pairs of blocks of the same frames, or states interpolated between frames."""

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from analysis import hermite
from analysis.meters import Part, parts_of
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import InputError, Problem


class OtherFramesError(InputError):
    """Two trajectories that do not have the same beads and times."""


def on_common_rows(first: Trajectory, second: Trajectory) -> tuple[Trajectory, Trajectory]:
    """Trajectories at the rows that both hold, where windows follow the pulse; else unchanged."""
    if not first.problem.rows.follow:
        return first, second
    rows = max(int(first.beads[0]), int(second.beads[0])), min(int(first.beads[-1]), int(second.beads[-1]))
    return first.on(*rows), second.on(*rows)


def near_the_front(block: Trajectory) -> Trajectory:
    """The half of a window's rows that is nearer to its head; all rows before any was dropped, or without a window.

    Rows near the tail lack the influence of those behind the window. That spreads into the window more slowly than
    the window moves on.
    """
    rows = block.problem.rows
    if not rows.follow or block.first == 1:
        return block
    head = int(block.beads[-1])
    return block.on(head - rows.existing // 2 + 1, head)


def of_common_atoms(first: Trajectory, second: Trajectory) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Displacements and velocities of two trajectories, each [frame, line, bead], of the atoms that both hold.

    These are the beads, and other atoms where both have recorded them.
    """
    (x, v), (other_x, other_v) = first.atoms, second.atoms
    lines = slice(min(x.shape[1], other_x.shape[1]))
    return (x[:, lines], v[:, lines]), (other_x[:, lines], other_v[:, lines])


def velocity_error(run: Trajectory, reference: Trajectory) -> float:
    """Largest difference of any velocity, of beads or other atoms, at the same times and rows; in units of V.

    NaN where a velocity is not a number.
    """
    (_, velocity), (_, right) = of_common_atoms(run, reference)
    return float(np.max(np.abs(velocity - right)))


def of_recorded(trajectory: Trajectory, problem: Problem) -> Trajectory:
    """Frames of a run at the beads that another problem records, which are some or all of those that it recorded.

    Other atoms are left out where beads are.
    """
    if problem.rows.neighbours:
        return replace(trajectory, problem=problem)
    return trajectory.recorded_in(problem, trajectory.problem.rows.positions(problem.rows.numbers))


def paired(first: Iterable[Trajectory], second: Iterable[Trajectory]) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Blocks of a run and of a reference with the same times, until the shorter one ends; of a window its front half.

    Args:
        first: consecutive frames of the run.
        second: consecutive frames of the reference, in blocks of any size.

    Yields:
        Two blocks with the same times and beads.

    Raises:
        OtherFramesError: the two do not have the same beads, or their frames differ in time.

    Examples:
        >>> frames = engine.run(granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem())
        >>> [(run.frames, reference.frames) for run, reference in paired([frames], [frames[:100], frames[100:]])]
        [(100, 100), (201, 201)]
    """
    for a, b in simultaneous(first, second):
        a, b = on_common_rows(near_the_front(a), b)
        if a.displacement.shape != b.displacement.shape or not np.array_equal(a.beads, b.beads):
            raise OtherFramesError("the two trajectories have different beads")
        yield a, b


def paired_parts(pairs: Iterable[tuple[Trajectory, Trajectory]]) -> Iterator[tuple[Part, Part]]:
    """Parts of two runs with the same times.

    Args:
        pairs: consecutive frames of both, such as those of `paired`: two blocks with the same times and beads.

    Yields:
        A part of the first run, and that of the second one.
    """
    first, second = itertools.tee(pairs)
    return zip(parts_of(block for block, _ in first), parts_of(block for _, block in second), strict=True)


def simultaneous(first: Iterable[Trajectory], second: Iterable[Trajectory]) -> Iterator[tuple[Trajectory, Trajectory]]:
    """Blocks of the two with the same times, until the shorter one ends; of a window all rows of each.

    Raises:
        OtherFramesError: their frames differ in time.
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
        if not np.allclose(a.time, b.time, rtol=1e-9, atol=1e-9):
            k = int(np.argmin(np.isclose(a.time, b.time, rtol=1e-9, atol=1e-9)))
            raise OtherFramesError(
                f"a frame is at t = {a.time[k]:.9g} (dimensionless), where {b.time[k]:.9g} is expected"
            )
        yield a, b


_NODES = (0, 1, 2, 3)

_SPARSER = 3
"""Frames from one to the next when the error is measured: halfway between two, that of velocities is at its least."""

_AT_ONCE = 512
"""Number of times whose polynomials are evaluated together, such that they stay in a processor's cache."""

MARGIN = 0.01
"""Extrapolation beyond the ends of a trajectory, in frames: for times that were rounded to six digits."""


def at_times(trajectory: Trajectory, times: Floats) -> Trajectory:
    """States at times [frame] within the trajectory's, by polynomials of degree seven.

    Times are in units of T. The states of contacts that yield are those of the frames before.

    Raises:
        InputError: a time lies outside by more than a hundredth of a frame, or there are fewer than four frames, or
            they are not evenly spaced.
    """
    instants = trajectory.time
    if trajectory.frames < len(_NODES):
        raise InputError(f"{trajectory.frames} frames are too few to interpolate between; at least {len(_NODES)}")
    spacing = (instants[-1] - instants[0]) / (trajectory.frames - 1)
    if not np.allclose(np.diff(instants), spacing, rtol=1e-6, atol=0.0):
        raise InputError("frames are not evenly spaced in time, so there is no interpolating between them")
    if len(times) and (times[0] < instants[0] - MARGIN * spacing or times[-1] > instants[-1] + MARGIN * spacing):
        raise InputError(
            f"times {times[0]:.6g} to {times[-1]:.6g} reach beyond the run's {instants[0]:.6g} to {instants[-1]:.6g} "
            "(dimensionless)"
        )
    start = np.clip(np.searchsorted(instants, times, side="right") - 2, 0, trajectory.frames - len(_NODES))
    before = np.clip(np.searchsorted(instants, times, side="right") - 1, 0, trajectory.frames - 1)
    x, v = trajectory.atoms
    windows, window = np.unique(start, return_inverse=True)  # few, where there are many times between two frames
    data = np.array([(x[windows + node], v[windows + node]) for node in _NODES])
    polynomials = hermite.coefficients(_NODES, data, float(spacing))
    slopes = hermite.derivative(polynomials)
    displacement, velocity = np.empty((2, len(times), *x.shape[1:]))
    for first in range(0, len(times), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        s = ((times[part] - instants[start[part]]) / spacing)[:, np.newaxis, np.newaxis] * np.ones(x.shape[1:])
        displacement[part] = hermite.value(np.take(polynomials, window[part], axis=1), s)
        velocity[part] = hermite.value(np.take(slopes, window[part], axis=1), s) / spacing
    return trajectory[before].with_motion(times, displacement, velocity)


def interpolation_error(trajectory: Trajectory) -> tuple[float, float]:
    """Bound on the largest error of displacement and velocity from `at_times`; infinite with fewer than 12 frames.

    Every third frame gives those in between with an error that is larger by 3**3.5 and 3**2.5 where a contact opens or
    closes, and by 3**8 and 3**7 elsewhere. The bound uses one power less, for safety.
    """
    if trajectory.frames < _SPARSER * len(_NODES):
        return float("inf"), float("inf")
    displacement = velocity = 0.0
    for first in range(_SPARSER):
        sparse = trajectory[first::_SPARSER]
        between = trajectory[first : first + _SPARSER * (sparse.frames - 1) + 1]
        between_sparse = at_times(sparse, between.time)
        displacement = max(displacement, float(np.max(np.abs(between_sparse.displacement - between.displacement))))
        velocity = max(velocity, float(np.max(np.abs(between_sparse.velocity - between.velocity))))
    return displacement / _SPARSER**2.5, velocity / _SPARSER**1.5
