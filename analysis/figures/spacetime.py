"""Velocity in space and time, and what is kept of a run to draw it.

Plug-ins take this module for maps: `space_time_meter` takes velocities from a run, `spacetime_sheet` has them as
panels, `panels` is their arrangement, and `RootScale` the scale of the colours.

Examples:
    >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
    >>> frames = engine.run(problem)
    >>> data = spacetime.space_time_meter(problem).read(frames.blocks())
    >>> spacetime.RootScale.of(problem, data.beads, data.velocity[:, 0]).ticks  # in units of V
    [-0.5, -0.2, -0.05, 0.0, 0.05, 0.2, 0.5]
    >>> drawing.draw(spacetime.spacetime_sheet(data)).savefig(tmp / "map.png", dpi=30)
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from analysis.figures.panels import (
    BEAD,
    Axis,
    FrameContent,
    Image,
    Panel,
    Sheet,
    axis_unit,
    evenly_spaced,
    grid,
    shown_chains,
    title,
)
from analysis.meters import Meter, Part
from analysis.trajectory import Flags, Floats, Integers
from lammps_inputs import Problem, physics
from lammps_inputs.units import Label

if TYPE_CHECKING:
    from matplotlib.colors import FuncNorm

MAX_PIXELS = 1200

PANELS_A_ROW = 4


@dataclass(frozen=True, eq=False)
class BeadHistory:
    """Velocity of some beads over time, in the chains that a figure shows.

    Attributes:
        problem: what was run.
        beads: [bead] their numbers.
        chains: that are shown, counted from 0.
        time: [frame] in units of T.
        velocity: [frame, chain, bead] in units of V; NaN where a window has left.
        until: time of the last frame of the run, in units of T.
    """

    problem: Problem
    beads: Integers
    chains: list[int]
    time: Floats
    velocity: Floats
    until: float


@dataclass(frozen=True, eq=False)
class HistoryMeter(Meter[tuple[Floats, Floats, float], BeadHistory]):
    """Velocity of some beads over time, in the chains that a figure shows.

    Attributes:
        problem: what was run.
        beads: [bead] their numbers.
        panels: whether each chain has a panel of its own.
        stride: number of frames from one that is taken to the next.
    """

    problem: Problem
    beads: Integers
    panels: bool = False
    stride: int = 1

    @property
    def _chains(self) -> list[int]:
        return shown_chains(self.problem, panels=self.panels)

    def of_part(self, part: Part) -> tuple[Floats, Floats, float]:
        """Times [frame] and velocities [frame, chain, bead] in a part, and the time of its last frame."""
        block, frames, chains = part.frames, part.every(self.stride), self._chains
        time, velocities = block.time[frames].copy(), block.velocity[frames][:, chains]
        column = block.positions(self.beads)
        held = (column >= 0) & (column < velocities.shape[2])
        velocity = np.where(column < 0, np.nan, np.zeros((len(time), len(chains), len(column))))
        velocity[..., held] = velocities[:, :, column[held]]
        return time, velocity, float(block.time[-1])

    def result(self, pieces: list[tuple[Floats, Floats, float]]) -> BeadHistory:
        """Velocities [frame, chain, bead] in the frames of all parts."""
        time, velocity, until = zip(*pieces, strict=True)
        return BeadHistory(
            self.problem, self.beads, self._chains, np.concatenate(time), np.concatenate(velocity), until[-1]
        )


def space_time_meter(problem: Problem) -> HistoryMeter:
    """A meter of as many recorded beads and frames as a picture can show, at most `MAX_PIXELS` each."""
    beads = problem.rows.numbers[:: max(1, -(-len(problem.rows.numbers) // MAX_PIXELS))]
    return HistoryMeter(problem, beads, panels=True, stride=max(1, -(-(problem.frames + 1) // MAX_PIXELS)))


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
    def norm(self) -> "FuncNorm":
        """Scale of matplotlib."""
        from matplotlib.colors import FuncNorm  # takes half a second to import

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


def _ends(data: BeadHistory) -> tuple[tuple[float, float], tuple[float, float]]:
    """Ends of the axes of beads and of time, half a bead and half a frame beyond the first and last."""
    half = 0.5 * float(data.time[-1] - data.time[0]) / max(1, len(data.time) - 1)
    instants = (float(data.time[0]) - half, float(data.time[-1]) + half)
    if not evenly_spaced(data.beads):
        return (-0.5, len(data.beads) - 0.5), instants
    step = float(data.beads[1] - data.beads[0])
    return (float(data.beads[0]) - 0.5 * step, float(data.beads[-1]) + 0.5 * step), instants


def spacetime_sheet(data: BeadHistory) -> Sheet:
    """Velocity in space and time, the chains side by side (the paper's Figs 1, 3 and 5), those of a lattice as in it.

    Where less than half of the beads are seen to move, they and some around them are shown. Colours diverge from a
    velocity of 0 and follow its square root, so that the weak tail is seen beside the pulse and the free end is not cut
    off. The scale ends where all beads do but those up to `RootScale.NEAR` from a kicked one. Beads that are not evenly
    spaced stand side by side in columns of one width. Without a value is what a window has left.
    """
    problem, chains = data.problem, data.chains
    time = axis_unit(problem, "time", data.time[-1])
    scale = RootScale.of(problem, data.beads, data.velocity)
    unit = axis_unit(problem, "velocity", scale.limit)
    velocity, limit = unit.axis(FrameContent, "velocity").label, scale.limit * unit.worth
    rows, columns = panels(problem, len(chains))
    places, instants = _ends(data)
    even = evenly_spaced(data.beads)
    x = (
        replace(BEAD, ends=scale.moving_part(data.velocity, data.beads, places))
        if even
        else Axis(Label("recorded bead"))
    )
    shown: list[Panel | None] = []
    for place, chain in enumerate(chains):
        image = Image(
            data.velocity[:, place] * unit.worth,
            places,
            (instants[0] * time.worth, instants[1] * time.worth),
            velocity,
            (-limit, limit),
            signed=True,
            missing="the window has left" if np.isnan(data.velocity).any() else "",
            columns=None if even else data.beads,
        )
        name = f"chain {chain + 1}" if len(chains) > 1 else ""
        shown.append(Panel(x, time.axis(FrameContent, "time"), title=name, image=image))
    shown += [None] * (rows * columns - len(chains))
    return Sheet(
        title(problem, each_chain=True, panels=True, until=data.until),
        [shown[row * columns : (row + 1) * columns] for row in range(rows)],
        0.6 + 3.6 * rows,
        2.2 + 2.4 * columns,
        same_y="all",
    )
