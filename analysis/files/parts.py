"""The dumps of a run that was continued, as one file of frames; atoms and columns are as of `binary_dump`."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.files.binary_dump import BinaryDump, NoFrameError, part_of_run
from analysis.trajectory import Floats
from lammps_inputs import InputError


class Parts:
    """Frames of one or more files in a row; a step that several hold comes from the first of them.

    Attributes:
        steps: [frame], time step numbers, ascending where each file's are.
        times: [frame], if LAMMPS wrote them into all the files, else None.
        box: [frame, axis, end or tilt]: xlo xhi xy, ylo yhi xz, zlo zhi yz; without tilt for an orthogonal box.
        columns: names of the columns but ``id``.
        n_atoms: how many atoms each frame has.
    """

    def __init__(self, paths: Sequence[Path | str]) -> None:
        """Index the files.

        Raises:
            InputError: a file is missing, no binary dump or damaged, or not of the same atoms and columns; or none of
                them holds a frame.

        Warns:
            CutDumpWarning: the last file ends within a frame, which is left out.
        """
        self._dumps = _opened(paths)
        first = self._dumps[0]
        kept, last = [], None
        for dump in self._dumps:
            if dump.columns != first.columns or not np.array_equal(dump.ids, first.ids):
                raise InputError(f"{dump.path}: holds other atoms or columns than {first.path}")
            kept.append(np.arange(dump.n_frames) if last is None else np.flatnonzero(dump.steps > last))
            last = dump.steps[-1] if last is None else max(last, dump.steps[-1])
        self._file: NDArray[np.int64] = np.repeat(np.arange(len(kept)), [len(frames) for frames in kept])
        self._frame: NDArray[np.int64] = np.concatenate(kept)
        self.n_atoms = first.n_atoms
        self.columns = tuple(name for name in first.columns if name != "id")
        pairs = list(zip(self._dumps, kept, strict=True))
        self.steps: NDArray[np.int64] = np.concatenate([dump.steps[frames] for dump, frames in pairs])
        times = [dump.times[frames] for dump, frames in pairs if dump.times is not None]
        self.times: Floats | None = np.concatenate(times) if len(times) == len(pairs) else None
        self.box: Floats = np.concatenate([_box(dump)[frames] for dump, frames in pairs])

    @property
    def n_frames(self) -> int:
        """Number of whole frames."""
        return len(self.steps)

    def read(self, frame: int, count: int) -> Floats:
        """[frame, column, atom] of a frame and of some that follow it in the same file, at most so many."""
        stop = int(np.searchsorted(self._file, self._file[frame], side="right"))
        start = int(self._frame[frame])
        dump: BinaryDump = self._dumps[self._file[frame]]
        return dump.read(start, start + min(count, stop - frame), columns=self.columns)


def _opened(paths: Sequence[Path | str]) -> list[BinaryDump]:
    """The dumps that hold a frame."""
    found: list[BinaryDump] = []
    for number, path in enumerate(paths, 1):
        try:
            found.append(part_of_run(path, last=number == len(paths)))
        except NoFrameError:
            if number == len(paths) and not found:
                raise
    return found


def _box(dump: BinaryDump) -> Floats:
    return dump.box if dump.tilt is None else np.dstack([dump.box, dump.tilt])
