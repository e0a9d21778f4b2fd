"""Branch of periodic states of a scene with a kick of velocity 1, with its frequencies and its stability."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain.parts import Flags, Floats, Problem
from workflow.plugins.derivatives import tangent
from workflow.plugins.modes import branches, lammps_check
from workflow.plugins.modes.linear import LinearModes, centre, linear_modes
from workflow.plugins.modes.tables import BranchOfMode

POINTS, BISECTIONS = 100, 6

PERIODS = lammps_check.PERIODS
"""Periods after which LAMMPS is compared with a stable state."""


@dataclass(frozen=True)
class PeriodicFamily(BranchOfMode):
    """Branch of periodic states of a scene whose kick has the velocity 1, so that all units are reduced ones.

    Attributes:
        plain: the scene.
        problem: its problem.
        linear: its linear modes.
    """

    plain: dict[str, Any]
    problem: Problem
    linear: LinearModes

    @property
    def frequency(self) -> Floats:
        """Angular frequencies, [state]."""
        return np.asarray(2.0 * np.pi / self.values("period"))

    @property
    def stable(self) -> Flags:
        """Whether each state is stable, [state]."""
        return np.array([periodic["stable"] for periodic in self.states], dtype=np.bool_)

    @property
    def participation(self) -> Floats:
        """Participation numbers of the beads' mean kinetic energies, [state]."""
        return np.array([centre(np.array(periodic["kinetic"]), self.problem.system)[0] for periodic in self.states])

    def changes(self, *kinds: str) -> list[dict[str, Any]]:
        """Changes of stability of some kinds, in order along the branch."""
        return [change for change in self.data["bifurcations"] if change["kind"] in kinds]

    def by_lammps(self, place: int) -> dict[str, Any]:
        """What LAMMPS makes of a state; see `workflow.plugins.modes.lammps_check.computed`."""
        name = str(self.plain["name"])
        return lammps_check.computed(self.plain, name, self.mode, self.states[place], self.data["steps"])


def follow(plain: dict[str, Any], mode: int, energy: float) -> PeriodicFamily:
    """The branch of a linear mode of a scene, counted from 0, or from the last one at -1, up to an energy."""
    name = str(plain["name"])
    problem = tangent.problem_of(plain, name)
    linear = linear_modes(problem, name)
    number = mode % len(linear.frequency)
    data = branches.computed(plain, name, number, energy, POINTS, [], BISECTIONS)
    return PeriodicFamily(number, data, plain, problem, linear)
