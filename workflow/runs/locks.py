"""Who may write: one run at a time in a directory, one process at a time in a file.

Locks are the kernel's: a killed process leaves none. Where a file system has none, all goes on without.
"""

import errno
import fcntl
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lammps_inputs import InputError

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
    """Read a file and write it anew with nobody else doing so in between; a run and its analysis share ``run.json``."""
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
