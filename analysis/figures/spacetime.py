"""Velocity in space and time, and what is kept of a run to draw it.

Plug-ins take this module to draw maps: `SpaceTime` collects the velocities of a run, `spacetime_figure` draws them,
`draw_maps` draws them into a figure of theirs, with `panels` for its shape; `RootScale` is the scale of the colours.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> data = watch(spacetime.SpaceTime(problem), frames.blocks())
    >>> spacetime.RootScale.of(problem, data.beads, data.velocity[:, 0]).ticks  # in units of V
    [-0.5, -0.2, -0.05, 0.0, 0.05, 0.2, 0.5]
    >>> spacetime.spacetime_figure(data).savefig(tmp / "map.png", dpi=30)
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import FuncNorm
from matplotlib.figure import Figure, FigureBase
from matplotlib.patches import Patch

from analysis.figures.style import (
    AxisUnit,
    FrameContent,
    axis_unit,
    evenly_spaced,
    grid,
    head,
    is_narrow,
    legend_below,
    letter,
    name_columns,
    new_figure,
    shown_chains,
    styled,
    title,
)
from analysis.trajectory import Flags, Floats, Integers, Trajectory
from lammps_inputs import Problem, physics

MAX_PIXELS = 1200

PANELS_A_ROW = 4

_LEFT = "0.75"
"""Colour of beads that a window has left."""

COLOUR_SCALE = "colour: signed square root"
"""What a bar of colours says of the scale."""


class BeadHistory:
    """Velocity of some beads over time, in the chains that a figure shows, from every n-th frame (``stride``).

    Attributes:
        problem: what was run.
        beads: [bead] their numbers.
        chains: that are shown, counted from 0.
        until: time of the last frame, also of one that is not kept.
    """

    def __init__(self, problem: Problem, beads: Sequence[int] | Integers, *, panels: bool = False, stride: int = 1):
        self.problem = problem
        self.beads: Integers = np.array(beads, dtype=np.int64)
        self.chains = shown_chains(problem, panels=panels)
        self.until = 0.0
        self._stride = stride
        self._seen = 0
        self._time: list[Floats] = []
        self._velocity: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames of the run."""
        frames = slice(-self._seen % self._stride, None, self._stride)
        self._seen += block.frames
        self.until = float(block.time[-1])
        time, velocities = block.time[frames].copy(), block.velocity[frames][:, self.chains]
        column = block.positions(self.beads)
        held = (column >= 0) & (column < velocities.shape[2])
        velocity = np.where(column < 0, np.nan, np.zeros((len(time), len(self.chains), len(column))))
        velocity[..., held] = velocities[:, :, column[held]]
        self._time.append(time)
        self._velocity.append(velocity)

    @property
    def time(self) -> Floats:
        """[frame], in units of T."""
        return np.concatenate(self._time)

    @property
    def velocity(self) -> Floats:
        """[frame, chain, bead], in units of V; NaN where a window has left."""
        return np.concatenate(self._velocity)


class SpaceTime(BeadHistory):
    """Velocity of as many recorded beads and frames as a picture can show, at most `MAX_PIXELS` each."""

    def __init__(self, problem: Problem) -> None:
        beads = problem.rows.numbers[:: max(1, -(-len(problem.rows.numbers) // MAX_PIXELS))]
        super().__init__(problem, beads, panels=True, stride=max(1, -(-(problem.frames + 1) // MAX_PIXELS)))


@dataclass(frozen=True)
class RootScale:
    """Scale of the colours of a map: they diverge from 0 and follow the signed square root of a value up to a limit.

    So the weak tail of a pulse is seen beside its front.

    Attributes:
        limit: size of the value at which the colours end.
    """

    PALETTE: ClassVar[str] = "RdBu_r"
    """Colours of matplotlib; white is 0."""

    NEAR: ClassVar[int] = 5
    """Beads beside a kicked one whose first motion is faster than any wave."""

    STILL: ClassVar[float] = 1e-3
    """Share of the limit below which a bead is nowhere seen to move."""

    limit: float

    @classmethod
    def of(cls, problem: Problem, beads: Integers, values: Floats) -> "RootScale":
        """Scale of values up to the largest farther than `NEAR` from kicked beads; of all if that is 0.

        Args:
            problem: what was run.
            beads: [bead] numbers of the beads.
            values: [..., bead] in any unit.

        Returns:
            The scale, whose limit is in the unit of the values.
        """
        size = np.abs(np.nan_to_num(values))
        kicked = [bead for _, bead, _ in physics.excitations(problem.system)]
        far = np.all([np.abs(beads - bead) > cls.NEAR for bead in kicked], axis=0)
        return cls(float(np.max(size[..., far], initial=0.0)) or float(np.max(size, initial=0.0)) or 1.0)

    @property
    def least(self) -> float:
        """Size of a value below which it is not seen."""
        return self.STILL * self.limit

    def moves(self, values: Floats) -> Flags:
        """Beads at which some values are seen.

        Args:
            values: [..., bead] in the unit of the limit.

        Returns:
            The mask, [bead].
        """
        size = np.abs(np.nan_to_num(values))
        return np.asarray(np.max(size, axis=tuple(range(size.ndim - 1)), initial=0.0) > self.least)

    def moving_part(self, values: Floats, places: Integers | Floats, ends: tuple[float, float]) -> tuple[float, float]:
        """Ends of the axis of beads: all, or those that move with as many around if they are less than half.

        Args:
            values: [..., bead] of the map, in the unit of the limit.
            places: [bead] numbers of the beads, or places on the axis, evenly spaced.
            ends: of the axis that shows all.
        """
        moving = np.flatnonzero(self.moves(values))
        if len(moving) == 0 or 2 * (moving[-1] + 1 - moving[0]) >= len(places):
            return ends
        step, more = places[1] - places[0], (moving[-1] + 1 - moving[0]) // 2
        low, high = max(0, moving[0] - more), min(len(places) - 1, moving[-1] + more)
        return float(places[low] - 0.5 * step), float(places[high] + 0.5 * step)

    @property
    def ticks(self) -> list[float]:
        """1, 2 or 5 times a power of ten, of either sign: about evenly spaced along the square root."""
        decade = 10.0 ** math.floor(math.log10(self.limit))
        largest = next(digit * decade for digit in (5.0, 2.0, 1.0) if digit * decade <= self.limit)
        digit = round(largest / decade)
        shares = {5: (1.0, 0.4, 0.1), 2: (1.0, 0.5, 0.1), 1: (1.0, 0.5, 0.1)}[digit]
        sizes = [float(f"{largest * share:.1g}") for share in shares]
        return [*(-size for size in sizes), 0.0, *reversed(sizes)]

    @property
    def norm(self) -> FuncNorm:
        """Scale of matplotlib."""
        return FuncNorm((self.root, _square), -self.limit, self.limit)

    @staticmethod
    def root(value: Floats) -> Floats:
        """Square root of the size of each value, with its sign.

        Args:
            value: [...] in any unit.

        Returns:
            [...] in the root of that unit.
        """
        return np.asarray(np.sign(value) * np.sqrt(np.abs(value)))


def _square(value: Floats) -> Floats:
    return np.asarray(np.sign(value) * np.square(value))


def panels(problem: Problem, chains: int) -> tuple[int, int]:
    """Rows and columns of panels for so many chains: those of a lattice that is all shown, else as few rows as fit.

    Args:
        problem: what is drawn.
        chains: number of chains that are shown.

    Returns:
        Number of rows, and of columns.
    """
    lattice = grid(problem)
    if lattice is not None and chains == problem.chains:
        return lattice
    rows = -(-chains // PANELS_A_ROW)
    return rows, -(-chains // rows)


def _ends(data: SpaceTime) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ends of the axes of beads and of time, half a bead and half a frame beyond the first and last."""
    half = 0.5 * float(data.time[-1] - data.time[0]) / max(1, len(data.time) - 1)
    instants = (float(data.time[0]) - half, float(data.time[-1]) + half)
    if not evenly_spaced(data.beads):
        return (-0.5, len(data.beads) - 0.5), instants
    step = float(data.beads[1] - data.beads[0])
    return (float(data.beads[0]) - 0.5 * step, float(data.beads[-1]) + 0.5 * step), instants


@styled
def spacetime_figure(data: SpaceTime) -> Figure:
    """Velocity in space and time, the chains side by side (the paper's Figs 1, 3 and 5), those of a lattice as in it.

    A single panel has no title. Grey: where the window has left.
    """
    rows, columns = panels(data.problem, len(data.chains))
    figure = new_figure(0.6 + 3.6 * rows, 2.2 + 2.4 * columns)
    draw_maps(figure, data)
    if np.isnan(data.velocity).any():
        legend_below(figure, [Patch(color=_LEFT)], ["the window has left"])
    head(figure, title(data.problem, each_chain=True, panels=True, until=data.until))
    return figure


def draw_maps(figure: FigureBase, data: SpaceTime) -> tuple[list[Axes], AxisUnit]:
    """Draw a map of velocity in space and time of each chain into a figure.

    Where less than half of the beads are seen to move, they and some around them are drawn. Colours diverge from a
    velocity of 0 and follow its square root, so that the weak tail is seen beside the pulse and the free end is not cut
    off. The scale ends where all beads do but those up to `NEAR` from a kicked one. Beads that are not evenly
    spaced stand side by side in columns of one width.

    Returns:
        The axes of the maps, and the unit of their times.
    """
    problem, chains = data.problem, data.chains
    time = axis_unit(problem, "time", data.time[-1])
    scale = RootScale.of(problem, data.beads, data.velocity)
    unit = axis_unit(problem, "velocity", scale.limit)
    shown_scale = RootScale(scale.limit * unit.worth)
    rows, columns = panels(problem, len(chains))
    even = evenly_spaced(data.beads)
    places, instants = _ends(data)
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axis in axes.flat[len(chains) :]:
        axis.remove()
    for place, chain in enumerate(chains):
        axis = axes.flat[place]
        image = axis.imshow(
            data.velocity[:, place] * unit.worth,
            origin="lower",
            aspect="auto",
            interpolation="nearest",
            extent=(*places, *(instant * time.worth for instant in instants)),
            cmap=RootScale.PALETTE,
            norm=shown_scale.norm,
            rasterized=True,
        )
        axis.set_facecolor(_LEFT)
        if len(chains) > 1:
            axis.set_title(f"chain {chain + 1}", loc="left")
        if place + columns >= len(chains):
            axis.set_xlabel("bead")
            axis.xaxis.set_tick_params(labelbottom=True)
        if not even:
            name_columns(axis, data.beads)
    if even:
        axes[0, 0].xaxis.get_major_locator().set_params(integer=True)
        axes[0, 0].set_xlim(*scale.moving_part(data.velocity, data.beads, places))
    letter(axes.flat[: len(chains)])
    for axis in axes[:, 0]:
        axis.set_ylabel(time.label(FrameContent, "time"))
    shape: dict[str, Any] = {"aspect": 20 * rows, "extendfrac": 0.05 / rows, "fraction": 0.15 / columns}
    beyond = "both" if float(np.nanmax(np.abs(data.velocity), initial=0.0)) > scale.limit else "neither"
    shown = list(axes.flat[: len(chains)])
    bar = figure.colorbar(image, ax=shown, ticks=shown_scale.ticks, extend=beyond, **shape)
    bar.ax.yaxis.set_major_formatter("{x:.4g}")
    bar.ax.minorticks_off()
    end = "\n" if is_narrow() else " "
    bar.set_label(f"{unit.label(FrameContent, 'velocity')};{end}{COLOUR_SCALE}")
    return shown, time
