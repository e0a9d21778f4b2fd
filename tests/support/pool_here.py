"""The processes of a sweep in the process of the tests, which saves starting them: for claims not about them."""

import os
from collections.abc import Generator, Iterator
from pathlib import Path

from lammps_here import standard_input

from workflow.sweep import worker
from workflow.sweep.jobs import Job
from workflow.sweep.pool import Answer


def answers(jobs: Iterator[tuple[str, Job]], _: int) -> Generator[tuple[str, Answer], None, None]:
    """As `workflow.sweep.pool.answers`, one job after the other."""
    where = Path.cwd()
    for key, job in jobs:
        try:
            with standard_input():
                answer = worker._answer(Job.from_line(job.line()))
        finally:
            os.chdir(where)
        yield key, answer
