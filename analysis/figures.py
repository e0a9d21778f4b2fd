"""Figures of a run: data in, matplotlib Figure out. Readable in print and by colour-blind eyes; nothing is saved here."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem

CHAIN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's palette, ordered for contrast between the first few."""

CHAIN_DASHES: tuple[object, ...] = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (5, 1, 1, 1)))

MAX_PIXELS = 1200
MAX_PANELS = 8


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
        self._velocity.append(block.velocity[first :: self._stride, :chains, :: self._thin].copy())
        self._seen += block.frames

    @property
    def time(self) -> Floats:
        """[frame], in units of T."""
        return np.concatenate(self._time)

    @property
    def velocity(self) -> Floats:
        """[frame, chain, bead], in units of V."""
        return np.concatenate(self._velocity)

    @property
    def beads(self) -> NDArray[np.int64]:
        """Numbers of the beads along the last axis."""
        return self.problem.recorded_beads[:: self._thin]


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
        self._velocity.append(block.velocity[:, :chains, self._columns])

    @property
    def time(self) -> Floats:
        """[frame], in units of T."""
        return np.concatenate(self._time)

    @property
    def velocity(self) -> Floats:
        """[frame, chain, bead], in units of V."""
        return np.concatenate(self._velocity)


def spacetime_figure(data: SpaceTime) -> Figure:
    """Velocity in space and time, the chains side by side (the paper's Figs 1, 3 and 5)."""
    problem, velocity = data.problem, data.velocity * data.problem.scale.velocity
    time, chains = data.time * problem.scale.time, velocity.shape[1]
    # the kicked bead outshines the waves: the scale ends where all but the first few beads do
    shown = np.abs(velocity[:, :, data.beads > min(5, data.beads[-1] - 1)])
    top = float(np.max(shown)) or float(np.max(np.abs(velocity))) or 1.0
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
        bar = figure.colorbar(image, ax=list(axes), extend="both")
        bar.set_label(f"velocity $v$ ({unit_label(problem, 'velocity')})")
        figure.suptitle(_title(problem))
    return figure


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
        figure.suptitle(_title(problem))
    return figure


def draw_chain(axis: Axes, chain: int, x: Floats, y: Floats) -> None:
    """One line in the colour and dash of a chain (counted from 0)."""
    axis.plot(
        x,
        y,
        color=CHAIN_COLOURS[chain % len(CHAIN_COLOURS)],
        linestyle=CHAIN_DASHES[chain % len(CHAIN_DASHES)],
        label=f"chain {chain + 1}",
    )


STYLE = {
    "font.size": 9,
    "axes.titlesize": 9,
    "figure.titlesize": 10,
    "lines.linewidth": 1.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}


def unit_label(problem: Problem, quantity: str) -> str:
    """The unit of a quantity on an axis of this scene."""
    return problem.scale.symbol(quantity) if problem.scale.si else "reduced"


def _title(problem: Problem) -> str:
    coupled = f", $\\kappa$ = {problem.kappa:.4g}" if problem.coupled else ""
    gap = f", gap {problem.gap:.4g}" if problem.gap else ""
    return f"{problem.name}: $N$ = {problem.chains}{coupled}{gap}"
