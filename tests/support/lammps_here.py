"""LAMMPS in the process of the tests, which saves starting one: for claims that are not about that process."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import TextIOBase
from pathlib import Path
from typing import Any

import pytest

from lammps_inputs import Problem
from workflow.engines.lammps import engine, hosted

_in_its_own_process = engine.run_deck


@contextmanager
def standard_input() -> Iterator[TextIOBase]:
    """The writing end of a pipe that is standard input meanwhile: a run of LAMMPS ends when it is closed."""
    reading, writing = os.pipe()
    with os.fdopen(reading) as ours, os.fdopen(writing, "w") as theirs, pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "stdin", ours)
        yield theirs


def run(directory: Path, *, ranks: int = 1, **options: Any) -> engine.LammpsOutcome:
    """As `engine.run_deck`; more ranks than one have processes of their own."""
    if ranks > 1:
        return _in_its_own_process(directory, ranks=ranks, **options)
    where = Path.cwd()
    with standard_input():
        try:
            return hosted.run(directory.absolute(), **options)
        finally:
            os.chdir(where)


def interrupted_after(step: int) -> Callable[..., engine.LammpsOutcome]:
    """A run that is told to end at its first report after a step, as by Ctrl-C, and so ends at the next."""

    def start(directory: Path, *, problem: Problem, **_: Any) -> engine.LammpsOutcome:
        where = Path.cwd()
        with standard_input() as pipe:

            def progress(done: int, _: int) -> None:
                if done >= step:
                    pipe.close()

            try:
                return hosted.run(directory.absolute(), problem=problem, progress=progress)
            finally:
                os.chdir(where)

    return start
