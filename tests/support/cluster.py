"""What the real schedulers have in common that tests start on this machine."""

import os
import re
import socket
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from executables import unavailable
from processes import HANGS, wait_until

from lammps_inputs import file_names
from workflow.plugins.jobs import job_files

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


def stop_after_a_stretch(directory: Path, steps: int = 1000) -> None:
    """Let the first job of a deck compute no more than one stretch of steps, until it is told to stop."""
    path, pause = directory / job_files.INPUT, directory / "pause"
    text = path.read_text().replace("label stretch", f"shell sh {pause.name}\n\nlabel stretch")
    text, count = re.subn("(?m)^(variable look equal) .*", rf"\1 {steps}", text)
    assert count == 1
    path.write_text(text)
    pause.write_text(f"[ -f {file_names.RESTART} ] || until grep stop {job_files.FLAG}; do sleep 0.1; done\n")
