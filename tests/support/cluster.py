"""What the real schedulers have in common that tests start on this machine."""

import os
import socket
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from executables import unavailable
from processes import HANGS, wait_until

POLLED = 0.2
"""Seconds between two looks at a queue: asking takes the scheduler and its command time that jobs need."""


@dataclass(frozen=True)
class Cluster(ABC):
    """A running scheduler.

    Attributes:
        environment: what its commands need.
    """

    environment: dict[str, str]

    def call(self, *words: object, cwd: Path | None = None) -> str:
        """Output of one of the scheduler's commands."""
        done = subprocess.run(
            [str(word) for word in words], cwd=cwd, env=self.environment, capture_output=True, text=True, timeout=HANGS
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    @abstractmethod
    def queue(self) -> list[str]:
        """Jobs and tasks that wait or run."""

    @abstractmethod
    def end(self) -> None:
        """End all jobs."""

    def wait(self) -> None:
        """Wait until all jobs have ended, also those that jobs submit."""
        assert wait_until(lambda: not self.queue(), every=POLLED), self.queue()


def as_root(title: str) -> None:
    """Skip a test where it is not root who runs it."""
    if os.geteuid():
        unavailable(f"{title} is started by root only")


def stop(processes: Sequence["subprocess.Popen[bytes]"]) -> None:
    """End processes, the last one first."""
    for process in reversed(processes):
        process.terminate()
    for process in processes:
        try:
            process.wait(HANGS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def free_ports(count: int) -> list[int]:
    """Ports of this machine that nothing listens to."""
    held = [socket.socket() for _ in range(count)]
    for one in held:
        one.bind(("127.0.0.1", 0))
    ports = [int(one.getsockname()[1]) for one in held]
    for one in held:
        one.close()
    return ports
