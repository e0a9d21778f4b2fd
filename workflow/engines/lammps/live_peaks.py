"""The leading pulse at every bead, found while LAMMPS runs: for chains whose frames nobody could keep."""

import io
import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis.peaks import PeakFinder
from analysis.trajectory import Floats, Trajectory, frames_per_block
from analysis.waves import leading_waves, to_csv
from lammps_inputs import Problem

PEAKS = "peaks.csv"
STATE = "chains.peaks.npz"
"""What was found until the restart that goes with it."""


class LivePeaks:
    """Looks at the states at the frames' times; holds some of them, and what it found.

    Args:
        problem: what LAMMPS computes.
        step: from which it goes on; 0 at the start.
    """

    def __init__(self, problem: Problem, step: int) -> None:
        self._problem = replace(problem, recorded=None)
        self._finder = PeakFinder(first_only=True)
        self._size = frames_per_block(self._problem)
        self._steps: list[int] = []
        self._states: list[tuple[Floats, Floats]] = []
        self._first = 1
        self._last = -1
        if step > 0:
            with np.load(STATE, allow_pickle=False) as state:
                self._finder = self._finder.resumed(self._problem, state)
                # it may be ahead of the restart, which was written after it
                self._last = round(float(state["time"][-1]) / problem.timestep)

    def next_step(self, step: int) -> int:
        """The step after this one at which a state is to be looked at."""
        return (step // self._problem.steps_per_frame + 1) * self._problem.steps_per_frame

    def add(self, step: int, displacement: Floats, velocity: Floats, first: int = 1) -> None:
        """Take a state, [chain, row] from row ``first`` on; steps of other times than a frame's are passed over."""
        if step % self._problem.steps_per_frame or step <= self._last:
            return
        self._last = step
        if first != self._first:
            self._look()
        self._first = first
        self._steps.append(step)
        self._states.append((displacement.copy(), velocity.copy()))
        if len(self._steps) >= self._size:
            self._look()

    def save(self) -> None:
        """Keep what was found for a run that goes on from here; before its restart is written."""
        self._look()
        content = io.BytesIO()
        state: dict[str, Any] = dict(self._finder.state())  # numbers only
        np.savez(content, **state)
        _write(Path(STATE), content.getvalue())

    def finish(self) -> None:
        """Write ``peaks.csv``, the columns of ``waves.csv`` that need no frames."""
        self._look()
        waves = leading_waves(self._finder.result())
        _write(Path(PEAKS), to_csv(waves, self._problem.scale).encode())
        Path(STATE).unlink(missing_ok=True)

    def _look(self) -> None:
        if not self._steps:
            return
        time = np.array(self._steps) / self._problem.steps_per_frame * self._problem.every
        displacement, velocity = (np.array([state[k] for state in self._states]) for k in (0, 1))
        self._finder.add(Trajectory(self._problem, time, displacement, velocity, first=self._first))
        self._steps, self._states = [], []


def _write(path: Path, content: bytes) -> None:
    """Whole or not at all, and on the disk."""
    unfinished = path.with_name(f".{path.name}.part")
    with unfinished.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    unfinished.replace(path)
