"""Velocity of a few beads over time."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.style import MAX_PANELS, STYLE, draw_chain, title, unit_label
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem


class BeadHistory:
    """Velocity of a few beads in all chains over time (the first chains, where there are many)."""

    def __init__(self, problem: Problem, beads: Sequence[int]) -> None:
        self.problem = problem
        self.beads = tuple(beads)
        self._columns = [int(np.flatnonzero(problem.recorded_beads == bead)[0]) for bead in beads]
        self._time: list[Floats] = []
        self._velocity: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames of the run."""
        chains = min(self.problem.chains, MAX_PANELS)
        self._time.append(block.time)
        column = np.array(self._columns) - (block.first - 1)
        there = (column >= 0) & (column < block.velocity.shape[2])
        velocity = np.where(column < 0, np.nan, np.zeros((block.frames, chains, len(column))))
        velocity[..., there] = block.velocity[:, :chains, column[there]]
        self._velocity.append(velocity)

    @property
    def time(self) -> Floats:
        """[frame], in units of T."""
        return np.concatenate(self._time)

    @property
    def velocity(self) -> Floats:
        """[frame, chain, bead], in units of V; NaN where a window has left."""
        return np.concatenate(self._velocity)


def response_figure(data: BeadHistory) -> Figure:
    """Velocity of chosen beads over time, all chains in one panel per bead (the paper's Figs 2, 4 and 6)."""
    problem = data.problem
    time, velocity = data.time * problem.scale.time, data.velocity * problem.scale.velocity
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 0.9 + 1.9 * len(data.beads)), layout="constrained")
        axes = figure.subplots(len(data.beads), 1, sharex=True, squeeze=False)[:, 0]
        for number, (bead, axis) in enumerate(zip(data.beads, axes, strict=True)):
            for chain in range(velocity.shape[1]):
                draw_chain(axis, chain, time, velocity[:, chain, number])
            axis.set_title(f"bead {bead}", loc="left")
            axis.set_ylabel(f"$v$ ({unit_label(problem, 'velocity')})")
        axes[-1].set_xlabel(f"time $t$ ({unit_label(problem, 'time')})")
        axes[0].legend(loc="upper right", ncols=2)
        figure.suptitle(title(problem, each_chain=True))
    return figure
