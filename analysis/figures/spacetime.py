"""Velocity in space and time."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.figures.style import MAX_PANELS, STYLE, title, unit_label
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

MAX_PIXELS = 1200


class SpaceTime:
    """Velocity on a grid of time and bead, thinned to what a picture can show while a run is read.

    Keeps every k-th frame, so that at most `MAX_PIXELS` are held however long the run is.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._stride = max(1, -(-(problem.frames + 1) // MAX_PIXELS))
        self._thin = max(1, -(-len(problem.recorded_beads) // MAX_PIXELS))
        self._seen = 0
        self._time: list[Floats] = []
        self._velocity: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames of the run."""
        first = -self._seen % self._stride
        chains = min(self.problem.chains, MAX_PANELS)
        self._time.append(block.time[first :: self._stride].copy())
        frames = block[first :: self._stride]
        if self.problem.window is not None:
            frames = frames.on(1, self.problem.beads, behind=np.nan)
        self._velocity.append(frames.velocity[:, :chains, :: self._thin].copy())
        self._seen += block.frames

    @property
    def time(self) -> Floats:
        """[frame], in units of T."""
        return np.concatenate(self._time)

    @property
    def velocity(self) -> Floats:
        """[frame, chain, bead], in units of V; NaN where a window has left."""
        return np.concatenate(self._velocity)

    @property
    def beads(self) -> NDArray[np.int64]:
        """Numbers of the beads along the last axis."""
        return self.problem.recorded_beads[:: self._thin]


def spacetime_figure(data: SpaceTime) -> Figure:
    """Velocity in space and time, the chains side by side (the paper's Figs 1, 3 and 5).

    Its magnitude where any kick is towards lower bead numbers.
    """
    problem, velocity = data.problem, data.velocity * data.problem.scale.velocity
    both_ways = any(kick < 0.0 for _, _, kick in problem.kicks)
    if both_ways:
        velocity = np.abs(velocity)
    time, chains = data.time * problem.scale.time, velocity.shape[1]
    # kicked beads and those at a free end outshine the waves: the scale ends where all beads but these do
    bright = [1, problem.beads, *(bead for _, bead, _ in problem.kicks)]
    far = np.all([np.abs(data.beads - bead) > 5 for bead in bright], axis=0)
    size = np.nan_to_num(np.abs(velocity))
    top = float(np.max(size[:, :, far], initial=0.0)) or float(np.max(size)) or 1.0
    if np.ptp(np.diff(data.beads)) > 0:  # a picture's columns are equally far apart: each shows the nearest bead
        place = np.linspace(data.beads[0], data.beads[-1], min(MAX_PIXELS, int(np.ptp(data.beads)) + 1))
        velocity = velocity[..., np.argmin(np.abs(place[:, np.newaxis] - data.beads), axis=1)]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(2.2 + 2.4 * chains, 4.2), layout="constrained")
        axes = figure.subplots(1, chains, sharex=True, sharey=True, squeeze=False)[0]
        for chain, axis in enumerate(axes):
            image = axis.imshow(
                velocity[:, chain],
                origin="lower",
                aspect="auto",
                interpolation="nearest",
                extent=(data.beads[0] - 0.5, data.beads[-1] + 0.5, time[0], time[-1]),
                cmap="magma_r",
                vmin=0.0,
                vmax=top,
                rasterized=True,
            )
            axis.set_title(f"chain {chain + 1}")
            axis.set_xlabel("bead")
        axes[0].set_ylabel(f"time $t$ ({unit_label(problem, 'time')})")
        bar = figure.colorbar(image, ax=list(axes), extend="max" if both_ways else "both")
        bar.set_label(f"velocity {'$|v|$' if both_ways else '$v$'} ({unit_label(problem, 'velocity')})")
        figure.suptitle(title(problem, each_chain=True))
    return figure
