"""A deck that has been read, on its way through time: steps, the window that follows the pulse, and the peaks.

The leading pulse at every bead is found while LAMMPS runs where a scene asks for it: for chains whose frames nobody
could keep.
"""

import ctypes
import io
import zipfile
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis import motion
from analysis.quantity import csv_of
from analysis.tracking.leading_waves import leading_passages, leading_waves
from analysis.tracking.peaks import PeakFinder
from analysis.trajectory import Floats, frames_per_block, of_atoms
from lammps_inputs import Problem, file_names, physics, scheme, window
from workflow.engines.lammps.files_on_disk import write_whole


class OutrunError(Exception):
    """The front has reached the head of the window, so it is no longer that of the whole chains."""


class Travel:
    """Drives an instance of LAMMPS; every rank calls the same methods.

    Attributes:
        first: row that the state begins with, counted from 1; more than 1 once a window has moved.
        energy_behind: energy of the rows that the window has left, in units of m V**2.
        heard: what the first rank said with the last state.
    """

    def __init__(self, lmp: Any, problem: Problem) -> None:
        self._lmp = lmp
        self._problem = problem
        self.first = 1 if problem.window is None else int(self._variable("tail"))
        self.energy_behind = 0.0
        self.heard = 0.0
        if self.first > 1:  # continued
            self.energy_behind = physics.energy(problem.system) - float(
                motion.energy(problem.system, *self.state(), self.first)
            )
        if problem.scheme != "verlet":
            self._commands([*scheme.QUIET])

    def advance(self, steps: int) -> None:
        """Run some steps.

        Raises:
            OutrunError: the front has outrun the window.
        """
        problem = self._problem
        if problem.window is None:
            self._run(steps)
            return
        look = window.stride(problem)
        while steps > 0:
            self._follow()
            self._run(min(look, steps))
            steps -= look

    def _follow(self) -> None:
        """Look where the front is, and move the window if need be."""
        self._commands(window.look_lines())
        if self._variable("outrun"):
            raise OutrunError(window.OUTRUN)
        if self._variable("near"):
            x, v = self.state()
            self._commands(window.move_lines())
            left = int(self._variable("tail")) - self.first
            stay = motion.energy(self._problem.system, x[:, left:], v[:, left:], self.first + left)
            self.energy_behind += float(motion.energy(self._problem.system, x, v, self.first)) - float(stay)
            self.first += left

    def state(self, word: float = 0.0) -> tuple[Floats, Floats]:
        """Displacement and velocity of the rows that exist, [line, row], the same on every rank.

        Lines are the chains and those of inner atoms after them. The first rank may say a word to all: it travels as
        the lateral velocity of its beads, which is zero otherwise.
        """
        problem = self._problem
        x = self._gathered("x")[..., 0]
        own = self._lmp.numpy.extract_atom("v")[:, 2]
        own[:] = word
        v = self._gathered("v")
        own[:] = 0.0
        self.heard, v = float(v[:, :, 2].max()), v[..., 0]
        row = np.arange(self.first, self.first + problem.rows)
        if self.first > 1:
            place = (row - 1) % problem.rows
            x, v = x[:, place], v[:, place]
        if problem.window is not None:
            return x - row * problem.layout.spacing, v
        places = problem.layout.places
        return x - (places if len(x) == len(places) else places[np.arange(len(x)) % len(places)]), v

    def _gathered(self, name: str) -> Floats:
        """[line, row, axis] of all atoms; as at rest where there is none."""
        system = self._problem.system
        shape = (physics.lines(system), self._problem.rows, 3)
        if system.inner_mass is None or np.all(system.inner_mass > 0.0):
            return np.ctypeslib.as_array(self._lmp.gather_atoms(name, 1, 3)).reshape(shape)
        ids = physics.atom_ids(system)
        found = np.zeros((shape[0] * shape[1], 3))
        wanted = (ctypes.c_int * len(ids))(*ids.tolist())
        some = self._lmp.gather_atoms_subset(name, 1, 3, len(ids), wanted)
        found[ids - 1] = np.ctypeslib.as_array(some).reshape(-1, 3)
        return found.reshape(shape)

    def _run(self, steps: int) -> None:
        if self._problem.scheme == "verlet":
            self._lmp.command(f"run {steps} pre no post no")
            return
        lines = scheme.cycle_lines(self._problem.scheme)
        for _ in range(steps // scheme.cycle(self._problem.scheme)):
            self._commands(lines)

    def _commands(self, lines: list[str]) -> None:
        for line in lines:
            self._lmp.command(line)

    def _variable(self, name: str) -> float:
        return float(self._lmp.extract_variable(name))


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
        self._finder = PeakFinder()  # all maxima: which pulse leads depends on later ones, too
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
        """Run some steps."""
        every = self._problem.steps_per_frame
        end = self._step + steps
        while self._step < end:
            goal = min(end, (self._step // every + 1) * every)
            self._travel.advance(goal - self._step)
            self._step = goal
            if goal % every == 0:
                self._take()

    def save(self) -> None:
        """Keep what was found for a run that is resumed here; before its restart is written."""
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
        waves = leading_waves(peaks, self._problem)
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
        self._finder.add(of_atoms(self._problem, time, displacement, velocity))
        self._steps, self._states = [], []
