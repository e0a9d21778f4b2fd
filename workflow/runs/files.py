"""The files of a directory: their names, who may write them, and how they are written whole.

One run at a time works in a directory, one process at a time in a file. Locks are the kernel's: a killed process
leaves none. Where a file system has none, none are taken. Files are written under another name, and then
renamed, so that a kill leaves them whole or not at all.
"""

import errno
import fcntl
import json
import math
import os
import re
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from lammps_inputs import InputError, file_names
from workflow.errors import EndedError

RECORD = "run.json"

OWN_FILES = (
    *(file_names.SCENE, file_names.DECK, file_names.TABLES, file_names.DATA, file_names.DUMP, file_names.LOG),
    RECORD,
    *(file_names.CONTINUE, file_names.RESTART, file_names.RESTART_SUMS, file_names.UNFINISHED),
)
LAMMPS_FILES = OWN_FILES
"""What the deck for LAMMPS, and a run of it, may leave in a directory before it is analysed."""

_PART = re.compile(r"chains\.dump(?:\.([1-9][0-9]{0,8}))?\.bin")


def parts(directory: Path) -> list[Path]:
    """The files of frames there are, in order."""
    return sorted((path for path in directory.iterdir() if part_number(path) and path.is_file()), key=part_number)


def part_number(path: Path) -> int:
    """Number of a file of frames; 0 if it is none."""
    match = _PART.fullmatch(path.name)
    return 0 if match is None else int(match[1] or 1)


_LOCK_SECONDS = 3.0
"""How long the processes of a killed run may take to end."""


@contextmanager
def alone(directory: Path) -> Iterator[int]:
    """Keep other runs out of a directory.

    Yields:
        A file descriptor: a process that inherits it keeps others out until it ends, too.

    Raises:
        InputError: something runs there.
        FileNotFoundError: it was removed, or another has taken its place.
    """
    handle = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        end = time.monotonic() + _LOCK_SECONDS
        while True:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > end:
                    raise InputError(f"{directory}: a run is under way in it; wait for its end, or end it") from None
                time.sleep(0.05)
            except OSError:  # a file system without locks
                break
        if not os.path.samestat(os.fstat(handle), directory.stat()):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(directory))
        yield handle
    finally:
        os.close(handle)


@contextmanager
def changing(path: Path) -> Iterator[None]:
    """Read and rewrite a file with no other process in between; a run and its analysis share ``run.json``."""
    while True:
        try:
            handle = os.open(path, os.O_RDONLY)
        except OSError:  # it is not there yet, or is nobody's who writes here
            yield
            return
        try:
            with suppress(OSError):  # a file system without locks
                fcntl.flock(handle, fcntl.LOCK_EX)
            with suppress(OSError):
                if not os.path.samestat(os.fstat(handle), path.stat()):
                    continue  # it was replaced meanwhile
            yield
            return
        finally:
            os.close(handle)


def held(directory: Path) -> bool | None:
    """Whether something runs in a directory; None on a file system without locks."""
    handle = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return None
    finally:
        os.close(handle)
    return False


TEMPORARY = ".granchain-"
"""In the name of a file that is being written, so that a kill leaves nothing that could be somebody else's."""

TEMPORARY_NAME = re.compile(rf"\..+{re.escape(TEMPORARY)}[a-z0-9_]{{4,8}}")


def _begin(path: Path, *, directory: bool) -> tuple[Path, int]:
    """Path of a new empty file or directory beside another one, and a descriptor that locks it while it is open."""
    prefix = f".{path.name}{TEMPORARY}"
    while True:
        if directory:
            temporary = Path(tempfile.mkdtemp(dir=path.parent, prefix=prefix))
        else:
            handle, name = tempfile.mkstemp(dir=path.parent, prefix=prefix)
            os.close(handle)
            temporary = Path(name)
        with suppress(FileNotFoundError):
            lock = os.open(temporary, os.O_RDONLY)
            with suppress(OSError):  # a file system without locks
                fcntl.flock(lock, fcntl.LOCK_EX)
            if temporary.exists():  # nobody took it for abandoned before it was locked
                return temporary, lock
            os.close(lock)


def remove_abandoned(directory: Path) -> None:
    """Remove files and directories that a killed process was writing: their names are ours, and nobody locks them."""
    with suppress(OSError), os.scandir(directory) as entries:
        abandoned = [Path(entry) for entry in entries if TEMPORARY_NAME.fullmatch(entry.name)]
        for path in abandoned:
            lock = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
            try:
                with suppress(OSError):  # it is locked, or the file system has no locks
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    discard(path)
            finally:
                os.close(lock)


def discard(path: Path) -> None:
    """Remove a file, or a directory with all that is in it."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


@contextmanager
def complete(path: Path, *, directory: bool = False, named: Path | None = None) -> Iterator[Path]:
    """Write a file, or a directory, under another name beside it, which becomes its name at the end of a block.

    What killed processes were writing there is removed.

    Args:
        path: the file; what was there before is replaced at the end, or is left as it was where something fails.
        directory: whether it is a directory.
        named: what an error names; by default the file.

    Yields:
        Path of an empty file or directory to write to.

    Raises:
        EndedError: it cannot be written; what was there before still is.

    Examples:
        >>> with complete(tmp / "table.csv") as path:
        ...     size = path.write_text("bead, time")
        >>> (tmp / "table.csv").read_text()
        'bead, time'
    """
    try:
        remove_abandoned(path.parent)
        temporary, lock = _begin(path, directory=directory)
        try:
            yield temporary
            temporary.chmod(0o755 if directory else 0o644)
            if directory and path.is_dir():
                before = Path(tempfile.mkdtemp(dir=path.parent, prefix=f".{path.name}{TEMPORARY}"))
                path.replace(before)
                temporary.replace(path)
                discard(before)
            else:
                temporary.replace(path)
        except BaseException:
            discard(temporary)
            raise
        finally:
            os.close(lock)
    except OSError as error:
        reason = error.strerror or error
        raise EndedError(f"{named or path}: cannot be written ({reason}); what was there is left as it was") from None


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file whole or not at all.

    Raises:
        EndedError: it cannot be written; what was there before still is.
    """
    with complete(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all.

    Examples:
        >>> write_text(tmp / "note.txt", "12 cases")
        >>> (tmp / "note.txt").read_text()
        '12 cases'
    """
    write_bytes(path, text.encode("utf-8"))


def write_json(path: Path, data: dict[str, Any]) -> None:
    """Write JSON whole or not at all; numbers round-trip, and what is not finite becomes null, for JSON has no NaN."""
    write_text(path, as_json(data) + "\n")


def as_json(data: Any) -> str:
    """JSON of plain data; what is not finite becomes null, for JSON has no NaN."""
    return json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False)


def _finite(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data
