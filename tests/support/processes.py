"""Which processes there are, for tests that end some and look for those left behind."""

import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

HANGS = 1800.0
"""Seconds after which something hangs, however busy the machine is: no claim is about them."""


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


def wait_until(condition: Callable[[], object], process: "subprocess.Popen[Any] | None" = None) -> bool:
    """Whether a condition came true; where a process is to make it true, it is not waited for after its end."""
    end = time.monotonic() + HANGS
    while not condition():
        if time.monotonic() > end or (process is not None and process.poll() is not None):
            return bool(condition())
        time.sleep(0.02)
    return True
