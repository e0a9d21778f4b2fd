"""Files that LAMMPS writes during a run: frames, of which all must be whole, and restarts.

LAMMPS itself may not notice that the disk took only a part of the frames. Restarts are written now and then, whole or
not at all; here is also which step one resumes from.
"""

import hashlib
import os
import struct
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lammps_inputs import file_names

if TYPE_CHECKING:  # status reads restarts, and loads no numpy
    from lammps_inputs import Problem


class FramesOnDisk:
    """Compares the size of a file with what it must be. All its frames have one size, that of the first ones.

    Args:
        path: the file.
        problem: the problem that the frames are of.
        begun: step that the file begins with; a frame falls on it, or is the next one after it.
    """

    def __init__(self, path: Path, problem: "Problem", begun: int) -> None:
        self._path = path
        self._every = problem.steps_per_frame
        self._first = -(-begun // self._every)
        self._size = 0
        self._least = 8 * 3 * problem.chains * problem.rows.count

    def whole(self, step: int) -> bool:
        """Whether the file holds every frame until a step."""
        frames = step // self._every - self._first + 1
        if frames < 1:
            return True
        size = self._path.stat().st_size
        if self._size == 0:
            self._size = size // frames
        return self._size > self._least and size == self._size * frames


EVERY = 30.0
"""Seconds of work that a kill may cost; a run that takes less writes none."""

SHARE = 0.01
"""Part of a run's time that restarts may take: where one takes long, fewer are written."""

_MAGIC = b"LammpS RestartT\0"
_TEXT, _STEP = (0, 4), 5


class Restarts:
    """Writes the restart of the run in the current directory from time to time.

    Args:
        lmp: an instance of LAMMPS; every rank calls the same methods.
        lines: commands that write one.
        frames: the file that it writes frames to.
        every: seconds from restart to restart.
        leads: whether this rank renames the file.
    """

    def __init__(self, lmp: Any, lines: Sequence[str], frames: Path, *, every: float, leads: bool) -> None:
        self._lmp = lmp
        self._lines = lines
        self._frames = frames
        self._every = every
        self._leads = leads
        self._last, self._cost = time.monotonic(), 0.0

    def due(self) -> bool:
        """Whether a restart is due, by the clock of this rank."""
        return time.monotonic() - self._last > max(self._every, self._cost / SHARE)

    def write(self) -> None:
        """Write a restart, between two cycles of the scheme.

        Raises:
            OSError: on the rank that leads: the disk does not take it, and an earlier one is still there.
        """
        started = time.monotonic()
        try:
            for line in self._lines:
                self._lmp.command(line)
        except Exception as error:  # LAMMPS raises nothing more specific
            if self._leads:
                Path(file_names.UNFINISHED).unlink(missing_ok=True)
            raise OSError(f"{file_names.RESTART} cannot be written; is the disk full?") from error
        if self._leads:
            keep(self._frames, int(self._lmp.extract_global("ntimestep")))
        self._last = time.monotonic()
        self._cost = self._last - started


def keep(frames: Path, step: int) -> None:
    """Put the restart that was written in place of an earlier one, when it and the frames until then are on the disk.

    Raises:
        OSError: they are not.
    """
    unfinished = Path(file_names.UNFINISHED)
    try:
        for path in (frames, unfinished):
            _to_disk(path)
        if step_of(unfinished) != step:
            raise OSError(f"{file_names.RESTART} cannot be written completely; is the disk full?")
        _note_sum(unfinished)
    except OSError:
        unfinished.unlink(missing_ok=True)
        raise
    unfinished.replace(file_names.RESTART)


def intact(path: Path) -> bool:
    """Whether a restart is, bit for bit, one that was noted when it was written: a damaged one hangs LAMMPS."""
    try:
        return _sum(path) in path.with_name(file_names.RESTART_SUMS).read_text(encoding="ascii").split()
    except (OSError, ValueError):
        return False


def _note_sum(unfinished: Path) -> None:
    """Note the sum of a restart before it takes the place of another, whose sum stays until then."""
    sums, restart = Path(file_names.RESTART_SUMS), Path(file_names.RESTART)
    before = [_sum(restart)] if restart.is_file() else []
    _write_whole(sums, ("\n".join([_sum(unfinished), *before]) + "\n").encode("ascii"))


def _write_whole(path: Path, content: bytes) -> None:
    """Write a file whole or not at all; it is on the disk when this returns."""
    unfinished = path.with_name(f".{path.name}.granchain-part")
    unfinished.write_bytes(content)
    _to_disk(unfinished)
    unfinished.replace(path)


def _sum(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def step_of(path: Path) -> int | None:
    """Step of a restart that LAMMPS wrote; None if there is none, or not a whole one."""
    try:
        with path.open("rb") as file:
            head = file.read(512)
            file.seek(-len(_MAGIC), os.SEEK_END)
            complete = file.read() == _MAGIC
    except OSError:
        return None
    if not (complete and head.startswith(_MAGIC)):
        return None
    try:
        return _step_in(head)
    except struct.error:
        return None


def _step_in(head: bytes) -> int | None:
    """The step in LAMMPS's header: fields of a number that says which, and an int32, a text or, the step, an int64."""
    at = len(_MAGIC) + 8
    while True:
        (field,) = struct.unpack_from("<i", head, at)
        if field == _STEP:
            return int(struct.unpack_from("<q", head, at + 4)[0])
        (value,) = struct.unpack_from("<i", head, at + 4)
        if value < 0:
            return None
        at += 8 + (value if field in _TEXT else 0)


def _to_disk(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
