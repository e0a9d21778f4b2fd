"""A deck that has been read, on its way through time: steps of its scheme, and the window that follows the pulse."""

from typing import Any

import numpy as np

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics, scheme, window
from lammps_inputs.limits import rates


class OutrunError(Exception):
    """The front has reached the head of the window, so it is no longer that of the whole chains."""


class Travel:
    """Drives an instance of LAMMPS; every rank calls the same methods.

    Attributes:
        first: row that the state begins with, counted from 1; more than 1 once a window has moved.
        left_behind: energy of the rows that the window has left, in units of m V**2.
        heard: what the first rank said with the last state.
    """

    def __init__(self, lmp: Any, problem: Problem) -> None:
        self._lmp = lmp
        self._problem = problem
        self.first = 1 if problem.window is None else int(self._variable("tail"))
        self.left_behind = 0.0
        self.heard = 0.0
        if self.first > 1:  # continued
            self.left_behind = physics.energy(problem.system) - float(
                motion.energy(problem.system, *self.state(), self.first)
            )
        if problem.scheme != "verlet":
            self._commands([*scheme.QUIET])

    def advance(self, steps: int) -> None:
        """Go on by some steps.

        Raises:
            OutrunError: the front has outrun the window.
        """
        problem = self._problem
        if problem.window is None:
            self._run(steps)
            return
        look = window.look_steps(problem.timestep, scheme.cycle(problem.scheme), rates.pace(problem.system))
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
            self.left_behind += float(motion.energy(self._problem.system, x, v, self.first)) - float(stay)
            self.first += left

    def state(self, word: float = 0.0) -> tuple[Floats, Floats]:
        """Displacement and velocity of the rows that exist, [chain, row], the same on every rank.

        The first rank may say a word to all: it travels as the lateral velocity of its beads, which is zero otherwise.
        """
        problem, chains = self._problem, self._problem.chains
        shape = (physics.lines(problem.system), problem.rows, 3)
        x = np.ctypeslib.as_array(self._lmp.gather_atoms("x", 1, 3)).reshape(shape)[:chains, :, 0]
        own = self._lmp.numpy.extract_atom("v")[:, 2]
        own[:] = word
        v = np.ctypeslib.as_array(self._lmp.gather_atoms("v", 1, 3)).reshape(shape)
        own[:] = 0.0
        self.heard, v = float(v[:, :, 2].max()), v[:chains, :, 0]
        row = np.arange(self.first, self.first + problem.rows)
        if self.first > 1:
            place = (row - 1) % problem.rows
            x, v = x[:, place], v[:, place]
        return x - (problem.layout.places if problem.window is None else row * problem.layout.spacing), v

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
