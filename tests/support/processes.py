"""Commands that tests run, and which processes there are, for tests that end some and look for those left behind."""

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

HANGS = 1200.0
"""Seconds after which something hangs, however busy the machine is: no claim is about them."""


@contextlib.contextmanager
def started(command: Sequence[object], **options: Any) -> Iterator[subprocess.Popen[str]]:
    """A command in a session of its own, as from a terminal; neither it nor its pipes outlive the block.

    A test that fails would otherwise leave them to the garbage collector, whose warnings fail another test.
    """
    words = [str(word) for word in command]
    pipe = subprocess.PIPE
    with subprocess.Popen(words, stdout=pipe, stderr=pipe, text=True, start_new_session=True, **options) as process:
        try:
            yield process
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


def output_of(*words: object, **options: Any) -> str:
    """Standard output of a command that ends with exit code 0."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=HANGS, **options)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


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


def children(pid: int) -> list[int]:
    """Processes that one has started and that still are."""
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def wait_until(
    condition: Callable[[], object], process: "subprocess.Popen[Any] | None" = None, *, every: float = 0.02
) -> bool:
    """Whether a condition came true; where a process is to make it true, it is not waited for after its end.

    It is looked at every so many seconds.
    """
    end = time.monotonic() + HANGS
    while not condition():
        if time.monotonic() > end or (process is not None and process.poll() is not None):
            return bool(condition())
        time.sleep(every)
    return True
