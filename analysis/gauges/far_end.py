"""What comes through chains: how hard their far wall is hit, when, and how much energy arrives at the far end."""

import numpy as np

from analysis import motion
from analysis.gauges.forces import at_frames
from analysis.gauges.gauge import gauges
from analysis.mirror import direction_of
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

PART = 10
"""The far end is the last row in so many."""


class FarEnd:
    """Watches the end of the chains that the hardest blow goes towards; all beads must be recorded."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        forward = direction_of(problem) > 0
        rows = max(1, problem.beads // PART)
        self._rows = slice(problem.beads - rows, problem.beads) if forward else slice(0, rows)
        named = gauges(problem, wall=True, contacts=(), sensors=())
        self._wall = tuple(gauge for gauge in named if gauge.name == ("right wall" if forward else "left wall"))
        self._time: list[Floats] = []
        self._energy: list[Floats] = []
        self._force: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        x, v = block.displacement[..., self._rows], block.velocity[..., self._rows]
        self._time.append(block.time.copy())
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
            energy = motion.bead_energy(self.problem, x, v, self._rows.start + 1)
            self._energy.append(np.sum(energy, axis=(1, 2)))
            if self._wall:
                self._force.append(at_frames(block, self._wall)[..., 0])

    def result(self) -> dict[str, float]:
        """Of the frames so far, dimensionless.

        | key                | what                                                                                |
        |--------------------|-------------------------------------------------------------------------------------|
        | wall_force         | largest force on the far wall of all chains together; only where there is a wall    |
        | wall_force_chain   | largest of any one chain; likewise                                                  |
        | delay              | when the wall is hit hardest; without one, when most energy is at the far end       |
        | transmitted_energy | most energy that is at the far end at any time, in that of the blows                |
        """
        time, energy = np.concatenate(self._time), np.concatenate(self._energy)
        when, most = _top(time, energy)
        found = {"delay": when, "transmitted_energy": most / self.problem.energy}
        if not self._wall:
            return found
        force = np.concatenate(self._force)
        when, hardest = _top(time, force.sum(axis=1))
        of_one = max(_top(time, column)[1] for column in force.T)
        return {"wall_force": hardest, "wall_force_chain": of_one, **found, "delay": when}


def _top(time: Floats, values: Floats) -> tuple[float, float]:
    """Where evenly sampled values are largest, and how large: the top of a parabola through the three around it."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(time[k]), float(values[k])
    before, at, after = values[k - 1 : k + 2].tolist()
    if not np.isfinite(before + at + after):
        return float(time[k]), float(values[k])
    bend = before - 2.0 * at + after
    shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float(time[k] + shift * (time[k + 1] - time[k])), float(at - 0.25 * (before - after) * shift)
