"""Time steps of a deck that LAMMPS has read, and the window that follows the pulse."""

import ctypes
from typing import Any

import numpy as np

from analysis import motion
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics, scheme, window


class OutrunError(Exception):
    """The front has reached the head of the window, so it is no longer that of the whole chains."""


class Travel:
    """Drives an instance of LAMMPS; every rank calls the same methods.

    Attributes:
        first: row that the state begins with, counted from 1; more than 1 once a window has moved.
        energy_behind: energy of the rows that the window has left, in units of m V**2.
        heard: message of the first rank with the last state.
    """

    def __init__(self, lmp: Any, problem: Problem) -> None:
        self._lmp = lmp
        self._problem = problem
        self.first = int(self._variable("tail")) if problem.rows.follow else 1
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
        if not problem.rows.follow:
            self._run(steps)
            return
        look = problem.steps_between_stops
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
        """Displacement and velocity of the rows that exist, [line, row], in units of L and V, equal on every rank.

        Lines are the chains and further ones after them. The first rank may say a word to all: it travels as
        the lateral velocity of its beads, which is zero otherwise.
        """
        problem = self._problem
        x = self._gathered("x")[..., 0]
        lateral = self._lmp.numpy.extract_atom("v")[:, 2]
        lateral[:] = word
        v = self._gathered("v")
        lateral[:] = 0.0
        self.heard, v = float(v[:, :, 2].max()), v[..., 0]
        row = np.arange(self.first, self.first + problem.rows.existing)
        if self.first > 1:
            place = (row - 1) % problem.rows.existing
            x, v = x[:, place], v[:, place]
        if problem.rows.follow:
            return x - row * problem.layout.spacing, v
        places = problem.layout.places
        return x - (places if len(x) == len(places) else places[np.arange(len(x)) % len(places)]), v

    def _gathered(self, name: str) -> Floats:
        """A property of all atoms, [line, row, axis]; 0 where there is no atom."""
        system = self._problem.system
        shape = (physics.lines(system), self._problem.rows.existing, 3)
        if np.all(physics.masses(system)):
            return np.ctypeslib.as_array(self._lmp.gather_atoms(name, 1, 3)).reshape(shape)
        ids = physics.atom_ids(system)
        values = np.zeros((shape[0] * shape[1], 3))
        wanted = (ctypes.c_int * len(ids))(*ids.tolist())
        some = self._lmp.gather_atoms_subset(name, 1, 3, len(ids), wanted)
        values[ids - 1] = np.ctypeslib.as_array(some).reshape(-1, 3)
        return values.reshape(shape)

    def _run(self, steps: int) -> None:
        if self._problem.scheme == "verlet":
            self._lmp.command(f"run {steps} pre no post no")
            return
        lines = scheme.cycle_lines(self._problem.scheme)
        for _ in range(steps // self._problem.cycle):
            self._commands(lines)

    def _commands(self, lines: list[str]) -> None:
        for line in lines:
            self._lmp.command(line)

    def _variable(self, name: str) -> float:
        return float(self._lmp.extract_variable(name))
