"""Tables of modes and periodic states: what their columns mean, and their lines."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain.parts import Floats, Problem, quantity, unit_cell
from workflow.plugins.modes.linear import LinearModes, centre

_ROUNDING = 1e-13
"""Relative uncertainty of a frequency below which it is not stated: that of Newton's method."""

UNMEASURED = "the state is stable, or the growth is too slow or too fast to be measured"


@quantity.result
class LinearMode:
    """A linear mode."""

    mode: int = quantity.declare("number of the mode, by ascending frequency", digits="d")
    frequency: float = quantity.declare("angular frequency", "frequency", symbol="\\omega", digits=".8g")
    participation: float = quantity.declare(
        "participation number of the atoms' mean kinetic energies e, (sum e)^2 / sum e^2", digits=".4g"
    )
    bead: float = quantity.declare("mean number of the bead, weighted with these energies", digits=".4g")
    chain: float = quantity.declare("mean number of the chain, weighted with these energies", digits=".4g")


@quantity.result
class StateLine:
    """A periodic state."""

    mode: int = quantity.declare("number of the linear mode whose branch it is on", digits="d")
    state: int = quantity.declare("number of the state along the branch", digits="d")
    role: str = quantity.declare(
        "``branch``: a point of the continuation; ``energy``: of a given energy; ``bifurcation``: just behind one",
        digits="",
    )
    energy: float = quantity.declare("energy above rest", "energy", digits=".6g", symbol="E")
    frequency: float = quantity.declare("angular frequency", "frequency", digits=".8g", symbol="\\omega")
    residual: float = quantity.declare(
        "norm of the velocities at half a period over that of the start, both weighted as energies", digits=".1e"
    )
    multiplier: float = quantity.declare(
        "largest modulus of its Floquet multipliers, without the pair at 1 of its own motion", digits=".7g"
    )
    tolerance: float = quantity.declare("deviation of that modulus from 1 that errors can cause", digits=".1e")
    stable: str = quantity.declare(
        "``yes`` where no multiplier is outside the unit circle by more than that, or ``no``", digits=""
    )
    participation: float = quantity.declare(
        "participation number of the atoms' mean kinetic energies e, (sum e)^2 / sum e^2", digits=".4g"
    )
    bead: float = quantity.declare("mean number of the bead, weighted with these energies", digits=".4g")
    chain: float = quantity.declare("mean number of the chain, weighted with these energies")
    least_overlap: float = quantity.declare(
        "overlap of neighbours where it is least over a period, at 33 times; less their distance where they are apart",
        "length",
        digits=".3g",
    )


@quantity.result
class BifurcationLine:
    """A change of stability along a branch."""

    mode: int = quantity.declare("number of the linear mode whose branch it is on", digits="d")
    kind: str = quantity.declare(
        "where the multipliers leave or enter the unit circle: ``+1``, ``-1``, ``collision`` (a pair elsewhere), or "
        "``fold`` (at 1, where the energy has an extremum)",
        digits="",
    )
    energy: float = quantity.declare("energy in the middle of the interval in which it is", "energy", digits=".6g")
    uncertainty: float = quantity.declare("half of that interval", "energy", digits=".1e")
    frequency: float = quantity.declare("angular frequency in the middle of the interval", "frequency", digits=".6g")
    before: int = quantity.declare("multipliers outside the unit circle before it", digits="d")
    after: int = quantity.declare("multipliers outside the unit circle after it", digits="d")


@quantity.result
class LammpsLine:
    """LAMMPS started on a periodic state."""

    mode: int = quantity.declare("number of the linear mode whose branch the state is on", digits="d")
    state: int = quantity.declare("number of the state along the branch", digits="d")
    energy: float = quantity.declare("energy above rest", "energy", digits=".6g")
    steps: int = quantity.declare("steps of LAMMPS in a period", digits="d")
    velocity: float = quantity.declare("norm of the velocities after a period", "velocity", digits=".3g")
    velocity_finer: float = quantity.declare("the same with twice the steps", "velocity", digits=".3g")
    order: float = quantity.declare("binary logarithm of their ratio; the scheme's order is 2", digits=".3f")
    distance: float = quantity.declare("distance from the start after a period", "length", digits=".2g")
    periods: int = quantity.declare("periods that were run", digits="d")
    later: float | None = quantity.declare(
        "distance from the start after these", "length", "the state is unstable", digits=".2g"
    )
    growth: float | None = quantity.declare(
        "rate at which a small deviation along the unstable direction grows, with twice the steps",
        "rate",
        UNMEASURED,
        digits=".6g",
    )
    uncertainty: float | None = quantity.declare(
        "the larger of its standard error and its difference from the rate with the steps",
        "rate",
        UNMEASURED,
        digits=".1e",
    )
    predicted: float | None = quantity.declare(
        "logarithm of the largest multiplier over the period", "rate", UNMEASURED, digits=".6g"
    )


@dataclass(frozen=True)
class BranchOfMode:
    """A branch, as it was computed.

    Attributes:
        mode: number of the linear mode, from 0.
        data: see `workflow.plugins.modes.branches.computed`.
    """

    mode: int
    data: dict[str, Any]

    @property
    def states(self) -> list[dict[str, Any]]:
        """Plain data of the states, in order."""
        states: list[dict[str, Any]] = self.data["states"]
        return states

    def values(self, key: str) -> Floats:
        """A number of each state, [state]."""
        return np.array([state[key] for state in self.states], dtype=np.float64)


@dataclass(frozen=True)
class ModesResult:
    """Linear modes and branches of a scene."""

    problem: Problem
    linear: LinearModes
    branches: list[BranchOfMode]
    checks: list[LammpsLine]

    def __repr__(self) -> str:
        states = sum(len(branch.states) for branch in self.branches)
        return f"<{len(self.linear.frequency)} linear modes of {self.problem.name}, {states} periodic states>"

    def modes(self) -> list[LinearMode]:
        """All linear modes."""
        return [
            LinearMode(number, float(frequency), *centre(energies, self.linear.system))
            for number, (frequency, energies) in enumerate(
                zip(self.linear.frequency, self.linear.energies, strict=True), 1
            )
        ]

    def states(self) -> list[StateLine]:
        """States of all branches."""
        lines = []
        for branch in self.branches:
            for number, state in enumerate(branch.states, 1):
                participation, bead, chain = centre(np.array(state["kinetic"]), self.problem.system)
                lines.append(
                    StateLine(
                        mode=branch.mode + 1,
                        state=number,
                        role=state["role"],
                        energy=state["energy"],
                        frequency=2.0 * math.pi / state["period"],
                        residual=state["residual"],
                        multiplier=state["largest"],
                        tolerance=state["tolerance"],
                        stable="yes" if state["stable"] else "no",
                        participation=participation,
                        bead=bead,
                        chain=chain,
                        least_overlap=state["least_overlap"],
                    )
                )
        return lines

    def bifurcations(self) -> list[BifurcationLine]:
        """Changes of stability of all branches."""
        lines = []
        for branch in self.branches:
            for change in branch.data["bifurcations"]:
                (low, high), periods = change["energies"], change["periods"]
                frequency = 4.0 * math.pi / sum(periods)
                middle, half = 0.5 * (low + high), 0.5 * abs(high - low)
                lines.append(
                    BifurcationLine(branch.mode + 1, change["kind"], middle, half, frequency, *change["outside"])
                )
        return lines

    def sentences(self) -> list[str]:
        """What came out, in sentences: bands, and each branch."""
        scale, lines = self.problem.scale, []
        if self.linear.zeros:
            lines.append(f"linear modes of the frequency 0: {self.linear.zeros} of {len(self.linear.frequency)}")
        edges = unit_cell.bands(self.problem.system)
        if edges is not None:
            texts = [" to ".join(f"{scale.measured(end, 'frequency'):.6g}" for end in band) for band in edges]
            lines.append(f"small waves of an infinite chain have frequencies from {', and from '.join(texts[:6])}")
        for branch in self.branches:
            lines += self._of_branch(branch)
        return lines

    def _of_branch(self, branch: BranchOfMode) -> list[str]:
        scale, number = self.problem.scale, branch.mode + 1
        if not branch.states:
            return [f"mode {number} has no branch: {branch.data['why']}"]
        last = branch.states[-1]
        energy = scale.written(last["energy"], "energy", ".6g")
        frequency = scale.written(2.0 * math.pi / last["period"], "frequency", ".9g")
        start = scale.written(float(self.linear.frequency[branch.mode]), "frequency", ".9g")
        uncertainty = branch.data["uncertainty"]
        error = ""
        if uncertainty is not None:
            change = max(uncertainty, _ROUNDING) * 2.0 * math.pi / last["period"]
            error = f" +- {scale.measured(change, 'frequency'):.0e}"
        line = (
            f"the branch of mode {number} (linear frequency {start}) has the frequency {frequency}{error} "
            f"at the energy {energy}; {branch.data['steps']} steps a period"
        )
        unstable = sum(not state["stable"] for state in branch.states)
        words = "all" if not unstable else f"{len(branch.states) - unstable} of"
        lines = [line, f"{words} {len(branch.states)} states of this branch are stable"]
        if branch.data["why"]:
            lines.append(f"the branch of mode {number} ends there: {branch.data['why']}")
        return lines

    def plain(self) -> dict[str, Any]:
        """Plain data of the result in the scene's units, for scripts."""
        scale = self.problem.scale
        return {
            "modes": quantity.plain(self.modes(), scale),
            "states": quantity.plain(self.states(), scale),
            "bifurcations": quantity.plain(self.bifurcations(), scale),
            "lammps": quantity.plain(self.checks, scale),
        }
