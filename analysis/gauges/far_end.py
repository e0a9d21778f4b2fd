"""What arrives at the far end of the chains: the force on the wall there, the energy, and the delay.

A quantity is undefined, NaN, where nothing has arrived, or the record ends before it has passed: a force or energy must
exceed the numerical noise, and its largest value must lie before the last frame (or it has stopped rising, `_settled`).
"""

import math

import numpy as np

from analysis import motion
from analysis.conservation import energy_input
from analysis.gauges.between_frames import Curve, crossing, maximum, top
from analysis.gauges.forces import at_frames, strain_at_frames, strain_between
from analysis.gauges.gauge import Gauge, far_wall
from analysis.mirror import direction_of
from analysis.quantity import declare, result
from analysis.trajectory import Floats, Integers, Trajectory
from lammps_inputs import Problem

PART = 10
"""The far end is the last row in so many."""

FAINTEST = 1e-9
"""Force above the static one from which something has arrived, as a share of the static force where that exceeds 1:
that of an overlap of 1e-6 L, far above rounding."""

FAINTEST_ENERGY = 1e-15
"""The same of the energy: that of an overlap of 1e-6 L."""

LEVEL = 1e-3
"""Relative change within which an energy has stopped rising, as where the last beads fly off a free end."""


UNPASSED = "nothing has arrived, or the record ends inside the pulse"


@result
class Transmitted:
    """What has arrived at the far end."""

    wall_force: float = declare(
        "largest force on the far wall, of all chains together, static load included",
        "force",
        f"there is no wall, {UNPASSED}",
        column="largest force on the far wall",
    )
    wall_force_chain: float = declare(
        "largest force of any one chain on the far wall, static load included",
        "force",
        f"there is no wall, {UNPASSED}",
        column="largest force of a chain on the far wall",
    )
    delay: float = declare(
        "time at which the force on the far wall is largest; without a wall, at which the energy at the far end first "
        "reaches half of its largest value",
        "time",
        UNPASSED,
        column="delay until the far end",
    )
    transmitted_energy: float = declare(
        "largest share at any time of the energy input until then (kicks, work of pushes and drives) that is in the "
        "last tenth of the beads, the contacts between them and that of the wall",
        undefined=f"{UNPASSED}, or the work is not known",
        column="largest energy at the far end / energy input",
    )


class FarEnd:
    """Watches the end of the chains that the hardest blow goes towards; all beads must be recorded."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        forward = direction_of(problem) > 0
        rows = max(1, problem.beads // PART)
        self._rows = slice(problem.beads - rows, problem.beads) if forward else slice(0, rows)
        wall = far_wall(problem.system)
        self._wall = () if wall is None else (wall,)
        self._time: list[Floats] = []
        self._energy: list[Floats] = []
        self._input: list[Floats] = []
        self._force: list[Floats] = []
        self._strain: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        x, v = block.displacement[..., self._rows], block.velocity[..., self._rows]
        self._time.append(block.time.copy())
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
            energy = motion.bead_energy(self.problem.system, x, v, self._rows.start + 1)
            self._energy.append(np.sum(energy, axis=(1, 2)))
            self._input.append(energy_input(block))
            if self._wall:
                self._force.append(at_frames(block, self._wall)[..., 0])
                self._strain.append(strain_at_frames(block, self._wall[0].probes[0]))

    def result(self) -> Transmitted:
        """Of the frames so far."""
        time, energy = np.concatenate(self._time), np.concatenate(self._energy)
        put_in = np.concatenate(self._input)
        share = np.divide(energy, put_in, out=0.0 * put_in, where=put_in > 0.0)
        late, transmitted = _settled(time, energy)[0], _settled(time, share)[1]
        if not self._wall:
            return Transmitted(math.nan, math.nan, late, transmitted)
        force, strain = np.concatenate(self._force), np.concatenate(self._strain, axis=1)
        chains = np.arange(self.problem.chains)
        when, hardest = _arrived(time, force, strain, chains, self._wall[0])
        of_one = float(
            np.fmax.reduce([_arrived(time, force, strain, one, self._wall[0])[1] for one in chains[:, None]])
        )
        return Transmitted(hardest, of_one, when, transmitted)


def _arrived(time: Floats, force: Floats, strain: Floats, chains: Integers, wall: Gauge) -> tuple[float, float]:
    """When the force of some chains on the wall is largest, and how large; NaN where nothing has arrived.

    Between frames it follows from the strain, as in `analysis.gauges.forces`.
    """
    total, static = force[:, chains].sum(axis=1), float(wall.static[chains].sum())
    k = int(np.argmax(total))
    if not 0 < k < len(time) - 1 or not np.all(np.isfinite(total[k - 1 : k + 2])):
        return np.nan, np.nan
    spacing = float(time[k] - time[k - 1])
    polynomial = strain_between(strain[:, k - 1 : k + 2, chains], spacing)
    curve = Curve(wall.probes[0], polynomial, np.tile(chains, 2), spacing)

    def value(s: Floats) -> Floats:
        return np.asarray(curve(np.repeat(s, len(chains))).reshape(2, -1).sum(axis=1))

    at = maximum(value, np.zeros(2), np.ones(2))
    most = value(at)
    best = int(np.argmax(most))
    if not max(most[best], total[k]) - static > FAINTEST * max(1.0, static):
        return np.nan, np.nan
    if most[best] < total[k]:
        return float(time[k]), float(total[k])
    return float(time[k - 1 + best] + at[best] * spacing), float(most[best])


def _settled(time: Floats, energy: Floats) -> tuple[float, float]:
    """When an energy has first reached half of its largest value, and that; NaN where none has arrived.

    An energy that is largest in the last frame must have been level for as long as it took from a quarter to half.
    """
    largest = float(np.max(energy))
    if not FAINTEST_ENERGY < largest < np.inf or energy[0] >= 0.5 * largest:  # there from the start
        return np.nan, np.nan
    quarter, half, level = (_reached(time, energy, share * largest) for share in (0.25, 0.5, 1.0 - LEVEL))
    if energy[-1] >= largest and time[-1] - level < half - quarter:
        return np.nan, np.nan
    most = top(time, energy)[1]
    return half, largest if np.isnan(most) else most


def _reached(time: Floats, values: Floats, level: float) -> float:
    """When values first reach a level."""
    k = int(np.argmax(values >= level))
    return crossing(time, values, k, level) if k else float(time[0])
