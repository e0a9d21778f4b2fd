"""What Slurm says of jobs that wait or run, where there is a Slurm to ask."""

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from lammps_inputs import file_names

_FORMAT = "%A|%t|%K|%Z"
_SECONDS = 15.0
_WAITING = ("PD", "RQ", "RH", "RF", "SE", "RD", "RV", "SO")


@dataclass(frozen=True)
class Queued:
    """A job or task of an array: its number, whether it still waits, and the directory that it works in."""

    number: str
    waiting: bool
    directory: Path


@dataclass(frozen=True)
class Queue:
    """The jobs of a cluster.

    Attributes:
        cluster: its name.
        jobs: all that wait or run.
    """

    cluster: str
    jobs: list[Queued] = field(default_factory=list)

    def job(self, number: str) -> Queued | None:
        """The job of a number, if it waits or runs."""
        return next((job for job in self.jobs if job.number == number), None)

    def job_in(self, directory: Path) -> Queued | None:
        """A job of a directory; one that runs before one that waits."""
        here = directory.resolve()
        found = [job for job in self.jobs if job.directory == here]
        return min(found, key=lambda job: job.waiting, default=None)


def ask() -> Queue | None:
    """What Slurm says; None where there is none to ask."""
    cluster = _said("scontrol", "show", "config")
    jobs = _said("squeue", "-h", "-r", "-o", _FORMAT)
    if cluster is None or jobs is None:
        return None
    name = next((line.split("=")[1].strip() for line in cluster.splitlines() if line.startswith("ClusterName")), "")
    return parse(name, jobs)


def parse(cluster: str, text: str) -> Queue:
    """The queue as ``squeue`` prints it; a task works in the directories of its line of the list."""
    queue = Queue(cluster)
    lists: dict[Path, list[str]] = {}
    for line in text.splitlines():
        number, state, task, directory = [*line.split("|", 3), "", "", ""][:4]
        where = Path(directory)
        places = [where]
        if task.isdigit():
            if where not in lists:
                lists[where] = _lines(where / file_names.CASES)
            if int(task) < len(lists[where]):
                places = [where / name for name in lists[where][int(task)].split()]
        queue.jobs.extend(Queued(number, state in _WAITING, place.resolve()) for place in places)
    return queue


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return []


def _said(*words: str) -> str | None:
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=_SECONDS, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout if done.returncode == 0 else None
