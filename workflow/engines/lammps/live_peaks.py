"""The leading pulse at every bead, found while LAMMPS runs: for chains whose frames nobody could keep."""

import io
import zipfile
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis.quantity import csv_of
from analysis.tracking.leading_waves import leading_finder, leading_passages, leading_waves, usual_arrival
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Floats, Trajectory, frames_per_block
from lammps_inputs import Problem, file_names
from workflow.engines.lammps.restarts import write_whole
from workflow.engines.lammps.travel import Travel


def usable(path: Path, problem: Problem, step: int) -> bool:
    """Whether a file holds, undamaged, what was found until a step or later."""
    try:
        with zipfile.ZipFile(path) as file:
            if file.testzip() is not None:
                return False
        with np.load(path, allow_pickle=False) as state:
            PeakFinder().resumed(replace(problem, recorded=None), state)
            return round(float(state["time"][-1]) / problem.timestep) >= step - step % problem.steps_per_frame
    except (OSError, ValueError, LookupError, EOFError, NotImplementedError, zipfile.BadZipFile, zlib.error):
        return False


class LivePeaks:
    """Takes a run onwards and looks at all beads at the frames' times; holds some of the states, and what it found.

    Args:
        travel: the run.
        problem: what it computes.
        step: where it is; 0 at the start.
        keeps: whether this rank does the looking; all take part in collecting the states.
    """

    def __init__(self, travel: Travel, problem: Problem, step: int, *, keeps: bool) -> None:
        self._travel = travel
        self._problem = replace(problem, recorded=None)
        self._keeps = keeps
        self._finder = leading_finder(problem)
        self._size = frames_per_block(self._problem)
        self._steps: list[int] = []
        self._states: list[tuple[Floats, Floats]] = []
        self._step, self._last = step, -1
        if step == 0:
            self._take()
        elif keeps:
            with np.load(file_names.PEAKS_STATE, allow_pickle=False) as state:
                self._finder = self._finder.resumed(self._problem, state)
                # it may be ahead of the restart, which was written after it
                self._last = round(float(state["time"][-1]) / problem.timestep)

    def advance(self, steps: int) -> None:
        """Go on by some steps."""
        every = self._problem.steps_per_frame
        end = self._step + steps
        while self._step < end:
            goal = min(end, (self._step // every + 1) * every)
            self._travel.advance(goal - self._step)
            self._step = goal
            if goal % every == 0:
                self._take()

    def save(self) -> None:
        """Keep what was found for a run that goes on from here; before its restart is written."""
        if not self._keeps:
            return
        self._look()
        content = io.BytesIO()
        state: dict[str, Any] = dict(self._finder.state())  # numbers only
        np.savez(content, **state)
        write_whole(Path(file_names.PEAKS_STATE), content.getvalue())

    def finish(self) -> None:
        """Write ``peaks.csv``: the columns of ``waves.csv`` that need no frames."""
        if not self._keeps:
            return
        self._look()
        peaks = leading_passages(self._finder.result(), self._problem)
        waves = leading_waves(peaks, usual_arrival(self._problem))
        write_whole(Path(file_names.PEAKS), csv_of(waves, self._problem.scale).encode())
        Path(file_names.PEAKS_STATE).unlink(missing_ok=True)

    def _take(self) -> None:
        displacement, velocity = self._travel.state()
        if not self._keeps or self._step <= self._last:
            return
        self._steps.append(self._step)
        self._states.append((displacement.copy(), velocity.copy()))
        if len(self._steps) >= self._size:
            self._look()

    def _look(self) -> None:
        if not self._steps:
            return
        time = np.array(self._steps) / self._problem.steps_per_frame * self._problem.every
        displacement, velocity = (np.array([state[k] for state in self._states]) for k in (0, 1))
        self._finder.add(Trajectory(self._problem, time, displacement, velocity))
        self._steps, self._states = [], []
