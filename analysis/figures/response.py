"""Velocity of a few beads over time."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analysis.figures.style import STYLE, axis_unit, chain_legend, draw_chain, shown_chains, title
from analysis.trajectory import Floats, Trajectory
from lammps_inputs import Problem


class BeadHistory:
    """Velocity of a few beads over time, in all chains or, where there are many, those of `shown_chains`."""

    def __init__(self, problem: Problem, beads: Sequence[int]) -> None:
        self.problem = problem
        self.beads = tuple(beads)
        self._columns = [int(np.flatnonzero(problem.recorded_beads == bead)[0]) for bead in beads]
        self._time: list[Floats] = []
        self._velocity: list[Floats] = []

    def add(self, block: Trajectory) -> None:
        """Take the next frames of the run."""
        chains = shown_chains(self.problem)
        self._time.append(block.time)
        column = np.array(self._columns) - (block.first - 1)
        there = (column >= 0) & (column < block.velocity.shape[2])
        velocity = np.where(column < 0, np.nan, np.zeros((block.frames, len(chains), len(column))))
        velocity[..., there] = block.velocity[:, chains][:, :, column[there]]
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
    """Velocity of chosen beads over time, all chains in one row per bead (the paper's Figs 2, 4 and 6).

    Left over the whole run, right the passage of the fastest pulse, its time from the instant when the bead is fastest
    in any chain. Beads that have not moved are named below, and not drawn.
    """
    problem = data.problem
    size = np.abs(np.nan_to_num(data.velocity)).max(axis=1, initial=0.0)  # [frame, bead]
    moved = np.flatnonzero(size.max(axis=0, initial=0.0) > STILL)
    drawn: list[int] = moved.tolist() or [0]
    time = axis_unit(problem, "time", data.time[-1])
    velocity = axis_unit(problem, "velocity", float(size.max(initial=0.0)))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 1.2 + 1.9 * len(drawn)), layout="constrained")
        axes = figure.subplots(len(drawn), 2, sharex="col", sharey="row", squeeze=False, width_ratios=(2.0, 1.0))
        spans = [_passage(data.time, size[:, number]) for number in drawn]
        close = max((axis_unit(problem, "time", high - low) for _, low, high in spans), key=lambda unit: -unit.worth)
        then = f" {time.symbol}" if problem.scale.si else ""
        for (whole, near), number, (middle, low, high) in zip(axes, drawn, spans, strict=True):
            _draw(whole, data, number, data.time * time.worth, velocity.worth)
            inside = (data.time >= low) & (data.time <= high)
            _draw(near, data, number, (data.time - middle) * close.worth, velocity.worth, inside)
            near.set_title(f"around $t$ = {middle * time.worth:.4g}{then}", loc="left")
            whole.set_title(f"bead {data.beads[number]}", loc="left")
            whole.set_ylabel(f"$v$ ({velocity.symbol})")
        axes[-1, 0].set_xlabel(f"time $t$ ({time.symbol})")
        axes[-1, 1].set_xlabel(f"time from then ({close.symbol})")
        chain_legend(figure, axes[0, 0])
        figure.suptitle(title(problem, each_chain=True, until=float(data.time[-1])) + _still(data, moved))
    return figure


STILL = 1e-9
"""Velocity, in units of V, below which a bead has not moved."""

_CLOSE = 0.1
"""Share of its largest velocity above which a bead counts as being passed."""

_MARGIN = 2.0
"""Time shown before and after a passage at least, in units of T."""


def _passage(time: Floats, size: Floats) -> tuple[float, float, float]:
    """When a bead is fastest, and the time around in which it is fast; ``size`` is [frame]."""
    top = int(np.argmax(size))
    slow = np.flatnonzero(size <= _CLOSE * size[top])
    first, last = slow[slow < top], slow[slow > top]
    low = time[first[-1]] if len(first) else time[0]
    high = time[last[0]] if len(last) else time[-1]
    margin = max(_MARGIN, 0.3 * float(high - low))
    return float(time[top]), float(low) - margin, float(high) + margin


def _draw(
    axis: Axes, data: BeadHistory, number: int, x: Floats, worth: float, inside: NDArray[np.bool_] | None = None
) -> None:
    chosen = slice(None) if inside is None else inside
    for place, chain in enumerate(shown_chains(data.problem)):
        draw_chain(axis, place, chain, x[chosen], data.velocity[chosen, place, number] * worth)


def _still(data: BeadHistory, moved: NDArray[np.int64]) -> str:
    still = [str(bead) for number, bead in enumerate(data.beads) if number not in moved]
    if not still:
        return ""
    return f"\nbead{'s' * (len(still) > 1)} {', '.join(still)} {'have' if len(still) > 1 else 'has'} not moved"
