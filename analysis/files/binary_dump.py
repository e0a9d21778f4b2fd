"""LAMMPS binary dumps (``dump ... custom FILE.bin``): an index of their frames, and what stands in them.

Pure numpy; the file format (`dump_layout`) and no physics. `recording` maps atoms to beads.
Numbers are float64 as LAMMPS computed them. Memory does not grow with the file. `Parts` are the dumps of a run that was
continued, as one file of frames.
"""

import os
import struct
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.files.dump_layout import BOX_AT, MAX_NAMES, PROBE_BYTES, STEP_AT, DumpLayout, parse
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import InputError

Bytes = NDArray[np.uint8]

_READ_BYTES = 1 << 20  # read at once: stays in the processor's cache while it is sorted


class CutDumpWarning(UserWarning):
    """A dump ends within a frame (the run was killed, or still writes); its whole frames are used."""


class NoFrameError(InputError):
    """A dump without one whole frame."""


def dumps_of(paths: Sequence[Path | str]) -> Iterator["BinaryDump | NoFrameError"]:
    """The dumps of a run that was continued, in order, or why one has no frame; only the last may warn that it is cut.

    Raises:
        InputError: a file is missing, is no binary dump with ids, or is damaged.
    """
    for number, path in enumerate(paths, 1):
        with warnings.catch_warnings():
            if number < len(paths):
                warnings.simplefilter("ignore", CutDumpWarning)
            try:
                dump: BinaryDump | NoFrameError = BinaryDump(path)
            except NoFrameError as error:
                dump = error
        yield dump


class BinaryDump:
    """One file of whole frames, each with the same atoms; nothing is kept open and nothing but the index in memory.

    Attributes:
        path: the file.
        steps: [frame], time step numbers, int64.
        times: [frame], as LAMMPS wrote them with ``dump_modify time yes``, else None.
        box: [frame, axis, end]: xlo xhi, ylo yhi, zlo zhi.
        columns: names of the columns, such as ``("id", "x", "vx")``.
        ids: [atom], ascending; the order of atoms in everything that is read.
        cut: whether the file ends within a frame, which is left out.

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0, "timestep": 0.05}).problem()
        >>> with recording.Writer(tmp / "dump.bin", problem) as writer:
        ...     writer.append(0, np.zeros((1, 20)), np.eye(1, 20))
        >>> dump = BinaryDump(tmp / "dump.bin")
        >>> dump.columns, dump.read(columns=["vx"]).shape  # [frame, column, atom]
        (('id', 'x', 'vx'), (1, 1, 20))
    """

    def __init__(self, path: Path | str) -> None:
        """Index the frames of a file.

        Raises:
            NoFrameError: the file is empty, or ends within its first frame.
            InputError: the file is missing, is no binary dump with ids, or is damaged; the text names it and says why.

        Warns:
            CutDumpWarning: the file ends within a frame, which is left out.
        """
        self.path = Path(path)
        with self._open() as file:
            self._index(file, file.seek(0, 2))
        ids = np.sort(self._frames(np.array([0]), ("id",), None)[0, 0])
        if not (np.all(np.diff(ids) > 0) and np.all(ids == np.floor(ids)) and ids[0] >= 1 and ids[-1] < 2**53):
            raise self._damaged(0, "the ids of its atoms are not different whole numbers")
        self.ids: Integers = ids.astype(np.int64)
        if self.cut:
            warnings.warn(
                CutDumpWarning(f"{path}: ends within a frame; the {self.n_frames} complete frames before it are read"),
                stacklevel=2,
            )

    @property
    def n_atoms(self) -> int:
        """Number of atoms in each frame."""
        return self._layouts[0].atoms

    @property
    def n_frames(self) -> int:
        """Number of whole frames."""
        return len(self.steps)

    @property
    def whole_bytes(self) -> int:
        """Bytes of the file until the end of its last whole frame."""
        return int(self._offsets[-1]) + self._layouts[int(self._kinds[-1])].size

    def read(
        self, start: int | None = None, stop: int | None = None, step: int | None = None, columns: Sequence[str] = ()
    ) -> Floats:
        """Frames of a slice (as of a Python list), the atoms of each in ascending order of id.

        Args:
            start: first frame.
            stop: frame before which to stop.
            step: number of frames from one to the next that is read.
            columns: names of the columns to keep; all of them by default.

        Returns:
            [frame, column, atom] in the units of the dump.

        Raises:
            InputError: a column is not there, or a frame is damaged or holds other atoms than the first frame.
        """
        names = tuple(columns) or self.columns
        missing = [name for name in names if name not in self.columns]
        if missing:
            raise InputError(f"{self.path}: has no column {missing[0]!r}; it has {' '.join(self.columns)}")
        return self._frames(np.arange(self.n_frames)[start:stop:step], names, self.ids)

    @contextmanager
    def _open(self) -> Iterator[FileIO]:
        try:
            with self.path.open("rb", buffering=0) as file:
                yield file
        except FileNotFoundError:
            raise InputError(f"{self.path}: no such file") from None
        except IsADirectoryError:
            raise InputError(f"{self.path}: is a directory, not a file") from None
        except OSError as error:
            raise InputError(f"{self.path}: cannot be read ({error.strerror or error})") from None

    def _index(self, file: FileIO, end: int) -> None:
        """Find the frames: the headers of frames of one layout stand at equal distances and are checked together."""
        layouts: dict[DumpLayout, int] = {}
        kinds, offsets, steps, boxes, times = [], [], [], [], []
        offset = frames = 0
        while offset < end:
            raw = _bytes_at(file, offset, PROBE_BYTES)
            try:
                try:
                    layout = parse(raw)
                except struct.error:  # long names, or the end of the file
                    raw = _bytes_at(file, offset, 2 * MAX_NAMES + PROBE_BYTES)
                    layout = parse(raw)
            except struct.error:
                break
            except ValueError as error:
                if frames == 0:
                    raise InputError(f"{self.path}: is not a LAMMPS binary dump of style custom: {error}") from None
                raise self._damaged(frames, str(error), offset) from None
            first_layout = next(iter(layouts), layout)
            if (layout.atoms, layout.columns) != (first_layout.atoms, first_layout.columns):
                raise self._damaged(frames, "another number of atoms or other columns", offset)
            template, fixed = np.frombuffer(raw, np.uint8, layout.header), _fixed(layout)
            batch, before = 1, frames
            while fitting := min(batch, (end - offset) // layout.size):
                places = range(offset, offset + fitting * layout.size, layout.size)
                joined = b"".join([_bytes_at(file, place, layout.header) for place in places])
                if len(joined) < fitting * layout.header:
                    raise InputError(f"{self.path}: changed while it was read")
                headers = np.frombuffer(joined, np.uint8).reshape(fitting, layout.header)
                alike = (headers[:, fixed] == template[fixed]).all(axis=1)
                count = fitting if alike.all() else int(np.argmin(alike))
                headers = headers[:count]
                kinds.append(np.full(count, layouts.setdefault(layout, len(layouts))))
                offsets.append(np.arange(count) * layout.size + offset)
                steps.append(_field(headers, STEP_AT, "<i8", 1)[:, 0])
                boxes.append(_field(headers, BOX_AT, "<f8", 6))
                if layout.time_at is not None:
                    times.append(_field(headers, layout.time_at, "<f8", 1)[:, 0])
                offset += count * layout.size
                frames += count
                if count < fitting:
                    break
                batch = min(2 * batch, 1 << 14)
            if frames == before:  # it does not fit into what is left of the file
                break
        if frames == 0:
            raise NoFrameError(f"{self.path}: " + ("ends within its first frame" if end else "is an empty file"))
        self.cut = offset < end
        self._layouts = list(layouts)
        self._kinds: Integers = np.concatenate(kinds)
        self._offsets: Integers = np.concatenate(offsets)
        self.columns = self._layouts[0].columns
        self.steps: Integers = np.concatenate(steps)
        self.box: Floats = np.concatenate(boxes).reshape(-1, 3, 2)
        timed = all(layout.time_at is not None for layout in self._layouts)
        self.times: Floats | None = np.concatenate(times) if timed else None

    def _frames(self, frames: Integers, names: tuple[str, ...], ids: Integers | None) -> Floats:
        """[frame, column, atom] of some frames by number; atoms as they stand in the file if no ids are given."""
        picked = [self.columns.index(name) for name in names]
        out = np.empty((len(frames), len(picked), self.n_atoms))
        done = 0
        with self._open() as file:
            while done < len(frames):
                kind = self._kinds[frames[done]]
                layout = self._layouts[kind]
                block = frames[done : done + max(1, _READ_BYTES // layout.size)]
                other = np.flatnonzero(self._kinds[block] != kind)
                block = block[: other[0]] if len(other) else block
                rows = self._rows(self._raw(file, block, layout), layout, block)
                target = out[done : done + len(block)]
                order = None if ids is None else self._order(rows[:, :, self.columns.index("id")], ids, block)
                for target_column, column in enumerate(picked):
                    values = rows[:, :, column]
                    if order is None:
                        target[:, target_column] = values
                    elif order.ndim == 1:
                        target[:, target_column] = values[:, order]
                    else:
                        target[:, target_column] = np.take_along_axis(values, order, axis=1)
                done += len(block)
        return out

    def _raw(self, file: FileIO, frames: Integers, layout: DumpLayout) -> Bytes:
        """[frame, byte] of frames of one layout."""
        offsets = self._offsets[frames]
        together = bool(np.all(np.diff(offsets) == layout.size))
        places = [(offsets[0], len(frames) * layout.size)] if together else [(at, layout.size) for at in offsets]
        content = b"".join([_bytes_at(file, int(at), count) for at, count in places])
        if len(content) == len(frames) * layout.size:
            raw = np.frombuffer(content, np.uint8).reshape(-1, layout.size)
            if np.array_equal(_field(raw, STEP_AT, "<i8", 1)[:, 0], self.steps[frames]):
                return raw
        raise InputError(f"{self.path}: changed while it was read")

    def _rows(self, raw: Bytes, layout: DumpLayout, frames: Integers) -> Floats:
        """Numbers of raw frames of one layout, [frame, atom, column], with atoms in the order of the file."""
        pieces = []
        at = layout.header
        for _ in range(layout.chunks):
            counts = _field(raw, at, "<i4", 1)
            count = int(counts[0, 0])
            if (counts != count).any():  # ranks exchanged atoms: frame by frame
                each = [self._rows(raw[i : i + 1], layout, frames[i : i + 1]) for i in range(len(raw))]
                return np.concatenate(each)
            at += 4 + 8 * count
            if count < 0 or at > layout.size:
                break
            pieces.append(raw[:, at - 8 * count : at])
        if at != layout.size or len(pieces) != layout.chunks:
            raise self._damaged(int(frames[0]), "its chunks do not add up to its atoms")
        together = np.concatenate(pieces, axis=1)
        return together.view("<f8").reshape(len(raw), layout.atoms, len(layout.columns))

    def _order(self, stored_ids: Floats, ids: Integers, frames: Integers) -> Integers | None:
        """Place of each atom: [atom] if the same in all frames, [frame, atom] if not, None if already in order."""
        alike = bool((stored_ids == stored_ids[0]).all())
        if alike and np.array_equal(stored_ids[0], ids):
            return None
        order = np.argsort(stored_ids[:1] if alike else stored_ids, axis=1, kind="stable")
        right = (np.take_along_axis(stored_ids[: len(order)], order, axis=1) == ids).all(axis=1)
        if not right.all():
            raise self._damaged(int(frames[np.argmin(right)]), "its atoms are not those of the first frame")
        return order[0] if alike else order

    def _damaged(self, frame: int, reason: str, offset: int | None = None) -> InputError:
        at = int(self._offsets[frame]) if offset is None else offset
        repair = f"; `head -c {at}` saves the frames before it" if frame else ""
        return InputError(f"{self.path}: frame {frame} (byte {at}) is damaged: {reason}{repair}")


def _bytes_at(file: FileIO, offset: int, count: int) -> bytes:
    return os.pread(file.fileno(), count, offset)


def _field(raw: Bytes, at: int, kind: str, count: int) -> NDArray[Any]:
    """[frame, count] of numbers at one place of every frame, copied since they are not aligned."""
    width = np.dtype(kind).itemsize * count
    return np.ascontiguousarray(raw[:, at : at + width]).view(kind)


def _fixed(layout: DumpLayout) -> Flags:
    """Mask, [byte], of the header's bytes that are the same in all frames of this layout."""
    mask = np.ones(layout.header, dtype=bool)
    mask[STEP_AT : STEP_AT + 8] = False
    mask[BOX_AT : BOX_AT + 48] = False
    if layout.time_at is not None:
        mask[layout.time_at : layout.time_at + 8] = False
    return mask


class Parts:
    """Frames of one or more files in a row; a step that several hold comes from the first of them.

    Attributes:
        steps: [frame], time step numbers, ascending where each file's are.
        times: [frame], if LAMMPS wrote them into all the files, else None.
        box: [frame, axis, end]: xlo xhi, ylo yhi, zlo zhi.
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
        dumps = list(dumps_of(paths))
        self._dumps = [dump for dump in dumps if isinstance(dump, BinaryDump)]
        if not self._dumps and isinstance(dumps[-1], NoFrameError):
            raise dumps[-1]
        first = self._dumps[0]
        new_frames, last = [], None
        for dump in self._dumps:
            if dump.columns != first.columns or not np.array_equal(dump.ids, first.ids):
                raise InputError(f"{dump.path}: holds other atoms or columns than {first.path}")
            new_frames.append(np.arange(dump.n_frames) if last is None else np.flatnonzero(dump.steps > last))
            last = dump.steps[-1] if last is None else max(last, dump.steps[-1])
        self._file: Integers = np.repeat(np.arange(len(new_frames)), [len(frames) for frames in new_frames])
        self._frame: Integers = np.concatenate(new_frames)
        self.n_atoms = first.n_atoms
        self.columns = tuple(name for name in first.columns if name != "id")
        pairs = list(zip(self._dumps, new_frames, strict=True))
        self.steps: Integers = np.concatenate([dump.steps[frames] for dump, frames in pairs])
        times = [dump.times[frames] for dump, frames in pairs if dump.times is not None]
        self.times: Floats | None = np.concatenate(times) if len(times) == len(pairs) else None
        self.box: Floats = np.concatenate([dump.box[frames] for dump, frames in pairs])

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
