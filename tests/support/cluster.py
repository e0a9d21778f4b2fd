"""What the real schedulers have in common that tests start on this machine."""

import os
import re
import shutil
import socket
import subprocess
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
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


@contextmanager
def daemons(
    title: str, needed: Sequence[str], executable: Callable[[str], Path]
) -> Iterator[tuple[Path, Callable[..., None], Callable[[Callable[[], bool]], None]]]:
    """A scheduler's directory, what starts a daemon in an environment, and what waits for the last one to do something.

    Nothing of them is left behind. Without the programs, or not as root, a test is skipped.
    """
    for name in needed:
        executable(name)
    if os.geteuid():
        unavailable(f"{title} is started by root only")
    home = Path("/run") / f"granchain-{title}-{os.getpid()}"  # sockets have short paths, and munge wants safe parents
    home.mkdir(mode=0o755)
    log, processes = home / "log", []

    def start(environment: dict[str, str], *words: object) -> None:
        with log.open("ab") as out:
            command = [str(word) for word in words]
            processes.append(
                subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out)
            )

    def wait(condition: Callable[[], bool]) -> None:
        assert wait_until(condition, processes[-1]), log.read_text()[-3000:]

    try:
        yield home, start, wait
    finally:
        for process in reversed(processes):
            process.kill()  # asked to end, some take ten seconds; nothing of theirs is kept
            process.wait()
        shutil.rmtree(home, ignore_errors=True)


def free_ports(count: int) -> list[int]:
    """Ports of this machine that nothing listens to."""
    with ExitStack() as held:
        sockets = [held.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [int(one.getsockname()[1]) for one in sockets]


def stop_after_a_stretch(directory: Path, steps: int = 1000) -> None:
    """Let the first job of a deck compute no more than one stretch of steps, until it is told to stop."""
    path, pause = directory / job_files.INPUT, directory / "pause"
    text = path.read_text().replace("label stretch", f"shell sh {pause.name}\n\nlabel stretch")
    text, count = re.subn("(?m)^(variable look equal) .*", rf"\1 {steps}", text)
    assert count == 1
    path.write_text(text)
    pause.write_text(f"[ -f {file_names.RESTART} ] || until grep stop {job_files.FLAG}; do sleep 0.1; done\n")
