"""Which processes there are, for tests that end some and look for those left behind."""

import time
from collections.abc import Callable
from pathlib import Path


def working_in(directory: Path) -> list[int]:
    """Processes whose working directory this is: LAMMPS's and the MPI launcher's are that of their run."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (process / "cwd").readlink() == directory.resolve():
                found.append(int(process.name))
        except OSError:
            continue
    return found


def wait_until(condition: Callable[[], object], seconds: float = 20.0) -> bool:
    """Whether a condition came true in time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.005)
    return bool(condition())
