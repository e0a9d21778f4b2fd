"""Processes that stay warm: jobs go in, answers come out; a process that dies is one failed job and is replaced."""

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Iterator
from typing import Any

from workflow import screen
from workflow.sweep.jobs import Job

_STOP_SECONDS = 60.0
"""For a segment of LAMMPS and a restart, however busy the machine is; a second Ctrl-C waits no longer."""

_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "BLIS_NUM_THREADS"), "1"
)

Answer = dict[str, Any]


def answers(jobs: Iterator[tuple[str, Job]], processes: int) -> Generator[tuple[str, Answer], None, None]:
    """Do jobs in several processes; yields the key and answer of each as it is done.

    Leaves no process behind, whatever happens to this one. When it is closed early, or interrupted, LAMMPS ends at its
    next segment.

    Args:
        jobs: key and job, taken one by one as processes become free.
        processes: how many.
    """
    everyone = {_Process() for _ in range(processes)}  # also those that are neither idle nor busy when Ctrl-C comes
    idle = list(everyone)
    busy: dict[_Process, str] = {}
    hints: set[str] = set()
    with selectors.DefaultSelector() as selector:
        try:
            while True:
                while idle and (following := next(jobs, None)) is not None:
                    key, job = following
                    process = idle.pop()
                    if not process.give(job):  # died while it had nothing to do
                        process = _replaced(process, everyone)
                        process.give(job)
                    busy[process] = key
                    selector.register(process.output, selectors.EVENT_READ, process)
                if not busy:
                    return
                for ready, _ in selector.select():
                    process = ready.data
                    for said in process.heard():
                        if "hint" in said:
                            if said["hint"] not in hints:
                                screen.hint(said["hint"])
                            hints.add(said["hint"])
                            continue
                        selector.unregister(process.output)
                        idle.append(process if process.alive() else _replaced(process, everyone))
                        yield busy.pop(process), said
        finally:
            for process in everyone:
                process.hang_up()
            until = time.monotonic() + _STOP_SECONDS
            for process in everyone:
                process.stop(until - time.monotonic())


def _replaced(process: "_Process", everyone: set["_Process"]) -> "_Process":
    process.stop(0.0)
    everyone.discard(process)
    following = _Process()
    everyone.add(following)
    return following


class _Process:
    """One worker."""

    def __init__(self) -> None:
        self._errors = tempfile.TemporaryFile("w+")  # noqa: SIM115  closed in `stop`
        # a session of its own, so that Ctrl-C does not reach it; -P: a directory it works in is no place for modules
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "workflow.sweep.worker"],
            env={**os.environ, **_ONE_THREAD},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            start_new_session=True,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._input, self.output = self._process.stdin, self._process.stdout
        self._said, self._begun = 0, b""

    def give(self, job: Job) -> bool:
        """Start a job; whether the process was there to take it."""
        self._said = os.fstat(self._errors.fileno()).st_size
        try:
            self._input.write(job.line())
            self._input.flush()
        except OSError:
            return False
        return True

    def heard(self) -> list[Answer]:
        """What it has said since it was last listened to: hints, and the answer to the job."""
        more = os.read(self.output.fileno(), 1 << 16)
        *lines, self._begun = (self._begun + more).split(b"\n")
        try:
            found = [json.loads(line) for line in lines]
        except ValueError:
            found = [None]
        if not more or not all(isinstance(each, dict) for each in found):
            return [self._ended()]
        if any(each.get("last") for each in found):
            self.hang_up()
        return found

    def _ended(self) -> Answer:
        """The answer of a process that gives none."""
        self.hang_up()
        code = self._process.wait()
        how = f"was killed by signal {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
        return {"end": "failed", "reason": f"the process that computed it {how}. {self._complaint()}".strip()}

    def _complaint(self) -> str:
        """What it printed last before it died: the first line, of a traceback the last."""
        self._errors.seek(self._said)
        lines = [line.strip() for line in self._errors.read(100_000).splitlines() if line.strip()]
        return "" if not lines else lines[-1] if lines[0].startswith("Traceback") else lines[0]

    def alive(self) -> bool:
        """Whether it can take another job."""
        return not self._input.closed and self._process.poll() is None

    def hang_up(self) -> None:
        """Ask it to end."""
        with contextlib.suppress(OSError):  # what was not written goes nowhere
            self._input.close()

    def stop(self, seconds: float) -> None:
        """End it, by force after some seconds."""
        self.hang_up()
        try:
            self._process.wait(max(0.0, seconds))
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            self._process.kill()
            self._process.wait()
        self.output.close()
        self._errors.close()
