"""Worker processes that stay warm: tasks go in, answers come out; a process that dies is one failed task.

A task names a function of this project, whose arguments and value are plain data (JSON):
``Task("workflow.sweep.run_sweep:run_case", {"path": "two-chains"})``.
"""

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from workflow import screen
from workflow.engines.lammps import mpi
from workflow.errors import complaint, how_it_ended

_STOP_SECONDS = 60.0
"""Time for a segment of LAMMPS and a restart, however busy the machine is; a second Ctrl-C waits no longer."""

_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "BLIS_NUM_THREADS"), "1"
)


class Task(NamedTuple):
    """What a worker process calls.

    Attributes:
        function: ``module:name``.
        arguments: arguments of the function by name, as plain data.
    """

    function: str
    arguments: dict[str, Any]


class TaskResult(NamedTuple):
    """Result of a task: the value of its function, or why there is none."""

    value: Any = None
    failed: str = ""


class Pool:
    """Worker processes, started when they are first needed.

    Leaves no process behind, whatever happens to this one. Where it ends early, LAMMPS ends at its next segment.

    Args:
        processes: how many; as many as there are cores by default.
        interrupt: whether tasks that are under way at an early end get Ctrl-C, too.
    """

    def __init__(self, processes: int | None = None, *, interrupt: bool = False) -> None:
        self.processes = processes or mpi.cores()
        self._interrupt = interrupt
        self._idle: list[_Process] = []
        self._everyone: set[_Process] = set()  # also those that are neither idle nor busy when Ctrl-C comes
        self._hints: set[str] = set()

    def __enter__(self) -> "Pool":
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._everyone:
            process.hang_up()
            if self._interrupt and process not in self._idle:
                process.interrupt()
        until = time.monotonic() + _STOP_SECONDS
        for process in self._everyone:
            process.stop(until - time.monotonic())
        self._everyone.clear()
        self._idle.clear()

    def answers(self, tasks: Iterable[tuple[Any, Task]]) -> Iterator[tuple[Any, TaskResult]]:
        """Do tasks; the key and the answer of each as it is done.

        Args:
            tasks: key and task, taken one by one as processes become free.
        """
        waiting = iter(tasks)
        busy: dict[_Process, Any] = {}
        with selectors.DefaultSelector() as selector:
            while True:
                while len(busy) < self.processes and (following := next(waiting, None)) is not None:
                    key, task = following
                    process = self._started(task)
                    busy[process] = key
                    selector.register(process.output, selectors.EVENT_READ, process)
                if not busy:
                    return
                for ready, _ in selector.select():
                    process = ready.data
                    for message in process.heard():
                        if "hint" in message:
                            self._hint(message["hint"])
                            continue
                        selector.unregister(process.output)
                        if process.alive():
                            self._idle.append(process)
                        else:
                            self._discard(process)
                        yield busy.pop(process), TaskResult(message.get("value"), message.get("failed", ""))

    def _started(self, task: Task) -> "_Process":
        """A process that has begun a task."""
        while self._idle:
            process = self._idle.pop()
            if process.give(task):
                return process
            self._discard(process)  # died while it had nothing to do
        process = _Process()
        self._everyone.add(process)
        process.give(task)
        return process

    def _discard(self, process: "_Process") -> None:
        process.stop(0.0)
        self._everyone.discard(process)

    def _hint(self, text: str) -> None:
        if text not in self._hints:
            screen.hint(text)
        self._hints.add(text)


class _Process:
    """One worker process."""

    def __init__(self) -> None:
        self._errors = tempfile.TemporaryFile("w+")  # noqa: SIM115  closed in `stop`
        # a session of its own, so that Ctrl-C does not reach it; -P: a directory it works in is no place for modules
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "workflow.workers.worker", str(os.getpid())],
            env={**mpi.environment(), **_ONE_THREAD},
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

    def give(self, task: Task) -> bool:
        """Start a task; whether the process was there to take it."""
        self._said = os.fstat(self._errors.fileno()).st_size
        try:
            self._input.write(json.dumps(task._asdict()) + "\n")
            self._input.flush()
        except OSError:
            return False
        return True

    def heard(self) -> list[dict[str, Any]]:
        """Messages since the last call: hints, and the answer to the task."""
        more = os.read(self.output.fileno(), 1 << 16)
        *lines, self._begun = (self._begun + more).split(b"\n")
        try:
            messages = [json.loads(line) for line in lines]
        except ValueError:
            messages = [None]
        if not more or not all(isinstance(each, dict) for each in messages):
            return [self._ended()]
        if any(each.get("last") for each in messages):
            self.hang_up()
        return messages

    def _ended(self) -> dict[str, Any]:
        """The failure that stands for the answer of a process that ended without one."""
        self.hang_up()
        how = how_it_ended(self._process.wait())
        self._errors.seek(self._said)
        reason = complaint(self._errors.read(100_000).splitlines())
        return {"failed": f"the process that computed it {how}. {reason}".strip()}

    def alive(self) -> bool:
        """Whether the process can take another task."""
        return not self._input.closed and self._process.poll() is None

    def hang_up(self) -> None:
        """Close the process's input, at which it ends."""
        with contextlib.suppress(OSError):  # what was not written goes nowhere
            self._input.close()

    def interrupt(self) -> None:
        """Send the process Ctrl-C, which does not reach it from a terminal."""
        self._process.send_signal(signal.SIGINT)

    def stop(self, seconds: float) -> None:
        """End the process, by force after some seconds."""
        self.hang_up()
        try:
            self._process.wait(max(0.0, seconds))
        except (subprocess.TimeoutExpired, KeyboardInterrupt):
            self._process.kill()
            self._process.wait()
        self.output.close()
        self._errors.close()
