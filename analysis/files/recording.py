"""A run's frames in a file: dumps read as a trajectory, block by block, and frames written as LAMMPS writes them.

Maps atoms to beads: atom = (chain - 1) * beads + bead, and where it rests. The file format is in
`binary_dump`.

Plug-ins take this module for dumps of LAMMPS: `blocks` and `read` read those of a problem, `Writer` writes one,
`all_ids` has the numbers of its atoms.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0, "timestep": 0.05}).problem()
    >>> with recording.Writer(tmp / "dump.bin", problem) as writer:
    ...     writer.append(0, np.zeros((1, 20)), np.eye(1, 20))  # [line, bead] in units of L and V
    >>> recording.read([tmp / "dump.bin"], problem).velocity[0, 0, :3]
    array([1., 0., 0.])
"""

import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Self

import numpy as np

from analysis.files.binary_dump import BinaryDump, CutDumpWarning, NoFrameError, dumps_of
from analysis.files.dump_layout import header
from analysis.trajectory import Floats, Integers, Trajectory, frames_per_block, joined
from lammps_inputs import InputError, Problem, physics


class OtherTimesError(InputError):
    """Frames at other times than those of the scene that they are read with."""


def rest_positions(problem: Problem) -> Floats:
    """[chain, recorded bead] x of the beads where LAMMPS has them at the start, to the last bit."""
    return np.asarray(problem.layout.places[:, problem.rows.numbers - 1])


def atom_ids(problem: Problem) -> Integers:
    """[chain, recorded bead] numbers of the recorded beads' atoms: (chain - 1) * rows + row, all rows in a window."""
    row = np.arange(1, problem.rows.existing + 1) if problem.rows.follow else problem.rows.numbers
    return np.arange(problem.chains)[:, np.newaxis] * problem.rows.existing + row


def rest_of_atoms(problem: Problem) -> Floats:
    """[atom] x of all atoms of a frame where LAMMPS has them at the start, to the last bit."""
    rest = rest_positions(problem)[problem.system.chain_of_line[: problem.lines]].ravel()
    return rest if problem.lines == problem.chains else np.asarray(rest[all_ids(problem) - 1])


def all_ids(problem: Problem) -> Integers:
    """Numbers of all atoms of a frame, [atom] ascending: the recorded beads, or all lines of atoms with all beads."""
    return physics.atom_ids(problem.system) if problem.lines > problem.chains else atom_ids(problem).ravel()


def blocks(paths: Sequence[Path], problem: Problem, stride: int = 1) -> Iterator[Trajectory]:
    """One or more dumps of a run, in order, as blocks of `trajectory.frames_per_block` frames.

    With a stride, frames in between are left unread. A step that several files hold (the run was continued) comes from
    the first of them; so does a file that ends within a frame if another follows. A file without a whole frame is
    passed over if another has one.

    Raises:
        InputError: a file is no binary dump or damaged, holds other atoms than the problem, or its steps go back, or
            frames are missing between it and the one before.
        OtherTimesError: frames are not at the times that the scene asks for.

    Warns:
        CutDumpWarning: the last file ends within a frame, which is left out; or one holds none, and frames are missing.
    """
    ids = all_ids(problem)
    size = frames_per_block(problem)
    last, frames_before = -1, 0
    empty: NoFrameError | None = None
    for dump in dumps_of(paths):
        if isinstance(dump, NoFrameError):
            empty = dump
            continue
        path = dump.path
        if not np.array_equal(dump.ids, ids):
            held = "all" if problem.rows.neighbours else f"{problem.rows.count} recorded"
            raise InputError(
                f"{path}: its {dump.n_atoms} atoms are not the {len(ids)} of {problem.name} "
                f"({problem.chains} chains, {held} of {problem.beads} beads)"
            )
        if not np.all(np.diff(dump.steps) > 0):
            raise InputError(f"{path}: its steps go back, so it is not one run")
        _check_times(dump, problem)
        new = int(np.searchsorted(dump.steps, last, side="right"))
        missing = int(dump.steps[new]) - last - problem.steps_per_frame if last >= 0 and new < dump.n_frames else 0
        if missing > 0:
            raise InputError(f"{path}: continues at step {dump.steps[new]}, but the file before ends at step {last}")
        first = new + (-frames_before) % stride
        frames_before += dump.n_frames - new
        for start in range(first, dump.n_frames, size * stride):
            chosen = slice(start, start + size * stride, stride)
            time = dump.steps[chosen] / problem.steps_per_frame * problem.every
            values = dump.read(chosen.start, chosen.stop, chosen.step, columns=problem.columns)
            try:
                yield from of_frames(problem, time, values)
            except ValueError as error:
                raise InputError(f"{path}: from frame {start} on, {error}") from None
        last = max(last, int(dump.steps[-1]))
    if empty is not None:
        if last < 0:
            raise empty
        if last + problem.steps_per_frame <= problem.steps:  # else it was to hold none
            warnings.warn(CutDumpWarning(f"{empty}; it is passed over"), stacklevel=2)


def read(paths: Sequence[Path], problem: Problem) -> Trajectory:
    """All frames of files in memory.

    Args:
        paths: the files.
        problem: what was run.

    Returns:
        The frames, [frame, chain, bead] in units of T, L and V.

    Raises:
        InputError: files cannot be used; see `blocks`.
    """
    return joined(blocks(paths, problem))


def of_frames(problem: Problem, time: Floats, values: Floats) -> Iterator[Trajectory]:
    """Frames as a block of all recorded beads, or of a window, as a block for each place that it stands at.

    Row r of a window stands for the atoms of the (r - 1) modulo the window's rows, since it moves by taking rows over
    its length.

    Args:
        problem: what was run.
        time: [frame] in units of T.
        values: [frame, column, atom], see `Problem.columns`; the array is changed in place.

    Raises:
        ValueError: the molecules are not rows of a window.
    """
    if problem.lines > problem.chains:
        yield _of_all_lines(problem, time, values)
        return
    values = values.reshape(len(time), -1, *atom_ids(problem).shape)
    if not problem.rows.follow:
        values[:, 0] -= rest_positions(problem)
        yield Trajectory.of_columns(problem, time, values)
        return
    tail = values[:, 0].min(axis=(1, 2)).astype(np.int64)
    for frames in np.split(np.arange(len(time)), np.flatnonzero(np.diff(tail)) + 1):
        row = np.arange(tail[frames[0]], tail[frames[0]] + problem.rows.existing)
        ordered = values[frames][..., (row - 1) % problem.rows.existing]
        if not np.all(ordered[:, 0] == row):
            raise ValueError(f"frame {frames[0]}: its molecules are not rows of a window")
        displacement = ordered[:, 1] - row * problem.layout.spacing
        yield Trajectory(problem, time[frames], displacement, ordered[:, 2], first=int(row[0]))


def _of_all_lines(problem: Problem, time: Floats, values: Floats) -> Trajectory:
    """Frames of all lines of atoms; places without an atom are at rest."""
    lines = problem.lines
    full = np.zeros((*values.shape[:2], lines * problem.beads))
    place = all_ids(problem) - 1
    full[..., place] = values
    full[:, 0, place] -= rest_of_atoms(problem)
    displacement, velocity = full.reshape(len(time), 2, lines, problem.beads).swapaxes(0, 1)
    return Trajectory.of_atoms(problem, time, displacement, velocity)


def _check_times(dump: BinaryDump, problem: Problem) -> None:
    """Refuse frames at other times than the scene's: everything that is measured would be wrong."""
    path, step = dump.path, problem.timestep
    if dump.times is not None and dump.steps[-1] > 0:
        step = float(dump.times[-1] / dump.steps[-1])
        if abs(step / problem.timestep - 1.0) > 1e-9:
            raise OtherTimesError(
                f"{path}: has a time step of {step:.6g}, its scene of {problem.timestep:.6g}; "
                "was the deck run with -var timestep?"
            )
    apart = np.unique(np.diff(dump.steps))
    if len(apart) and (len(apart) > 1 or apart[0] != problem.steps_per_frame):
        expected = problem.steps_per_frame
        raise OtherTimesError(
            f"{path}: has frames {apart[0]} steps apart, its scene asks for {expected}; "
            "was the deck run with -var every?"
        )


class Writer:
    """Writes a binary dump as LAMMPS does; each frame is on its way to the disk when `append` returns.

    Use it in a ``with`` statement, or `close` it.
    """

    def __init__(self, path: Path | str, problem: Problem) -> None:
        """Begin a dump of the recorded beads, or of all atoms with all of them; an existing file is replaced."""
        self._shape = problem.lines, problem.rows.count
        ids = all_ids(problem)
        self._rest = rest_of_atoms(problem)
        self._timestep = problem.timestep
        self._place = slice(None) if problem.lines == problem.chains else ids - 1
        self._names = " ".join(("id", "x", "vx", *problem.state_columns))
        self._rows = np.empty((len(ids), 3 + len(problem.state_columns)), dtype="<f8")
        self._rows[:, 0] = ids
        width = 2.0 * (problem.layout.diameter + physics.gap(problem.system))
        self._lateral = (-width, width * problem.lines, -width, width)
        self._file = Path(path).open("wb")  # noqa: SIM115  closed by `close`

    def append(self, step: int, displacement: Floats, velocity: Floats, *columns: Floats) -> None:
        """Write one frame.

        Args:
            step: number of the time step.
            displacement: [line, recorded bead] in units of L, further lines of atoms after the chains
                (`Trajectory.atoms`).
            velocity: [line, recorded bead] in units of V, with the same lines.
            *columns: [chain, recorded bead] of each column of `Problem.state_columns`.

        Raises:
            ValueError: an array has another shape, or a column is missing.
        """
        rows = self._rows
        for values in (displacement, velocity):
            if values.shape != self._shape:
                raise ValueError(f"array of shape {values.shape}; [chain, recorded bead] is {self._shape}")
        rows[:, 1] = self._rest + displacement.ravel()[self._place]
        rows[:, 2] = velocity.ravel()[self._place]
        for place, column in zip(range(3, rows.shape[1]), columns, strict=True):
            rows[:, place] = column.ravel()
        x = rows[:, 1]
        box = (x.min(), x.max(), *self._lateral)
        head = header(step, step * self._timestep, x.size, box, self._names)
        self._file.write(head + rows.tobytes())
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
