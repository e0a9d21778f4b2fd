"""Figures of periodic states: their frequency over energy, shapes, Floquet multipliers, and motion over a period."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granchain.parts import Flags, Floats, style, units

MOST_CHAINS = 4
"""Chains that a figure shows at most."""


@dataclass(frozen=True)
class BranchCurve:
    """States of a branch, in the scene's units.

    Attributes:
        name: in titles and legends.
        last_state: number and energy of the last state, in titles.
        energy, frequency: [state].
        stable: [state].
        bifurcations: energy and frequency of changes of stability, [change, 2].
        linear: displacements of the linear mode, [line, bead], in any unit.
        last: those of the last state at its start.
        multipliers: complex Floquet multipliers of the last state.
        motion: displacements [time, line, bead] over a period of the last state, at even times.
        period: of the last state.
        chains: number of chains, whose lines are the first.
    """

    name: str
    last_state: str
    energy: Floats
    frequency: Floats
    stable: Flags
    bifurcations: Floats
    linear: Floats
    last: Floats
    multipliers: Any
    motion: Floats
    period: float
    chains: int


@style.styled
def frequency_figure(
    branches: Sequence[BranchCurve], bands: Floats, labels: tuple[units.Label, units.Label], title: str
) -> Figure:
    """Frequency of the states over their energy, a panel for each branch.

    Args:
        branches: what is drawn.
        bands: frequencies of the edges of bands, [edge], of which those within a panel are drawn.
        labels: of energy and frequency.
        title: for the top.
    """
    figure = style.new_figure(3.2, 3.6 * max(2, min(3, len(branches))))
    axes = np.ravel(figure.subplots(1, len(branches), squeeze=False))
    for axis, branch in zip(axes, branches, strict=True):
        _draw_by_stability(axis, branch.energy, branch.frequency, branch.stable)
        if len(branch.bifurcations):
            axis.plot(*branch.bifurcations.T, "o", color="black", markersize=4, label="change of stability")
        limits = axis.get_ylim()
        for edge in bands[(bands > limits[0]) & (bands < limits[1])]:
            axis.axhline(edge, color="0.6", linewidth=0.8, label="edge of a band of small waves")
        axis.set_xscale("log")
        axis.set_title(branch.name)
        style.label_axis(axis.xaxis, labels[0])
        style.label_axis(axis.yaxis, labels[1])
    style.letter(axes)
    style.head(figure, title)
    _legend_of_all(figure, axes)
    return figure


def _draw_by_stability(axis: Axes, x: Floats, y: Floats, stable_states: Flags) -> None:
    """Draw a curve through states, [state], solid where they are stable and dashed where they are not."""
    for stable, dashes in ((True, "-"), (False, (0, (3, 2)))):
        shown = stable_states == stable
        if not np.any(shown):
            continue
        joined = shown.copy()
        joined[1:] |= shown[:-1]  # the piece between two belongs to the state before
        name = "stable" if stable else "unstable"
        values = np.where(joined, y, np.nan)
        axis.plot(x, values, color=style.CHAIN_COLOURS[not stable], linestyle=dashes, label=name)


@style.styled
def response_figure(
    curve: Floats, stable: Flags, marked: Mapping[str, Floats], labels: tuple[units.Label, units.Label], title: str
) -> Figure:
    """Amplitude of periodic responses over the frequency of the drive, with folds and LAMMPS's sweep.

    Args:
        curve: frequency and amplitude of the responses in order, [response, 2].
        stable: [response].
        marked: points by name, [point, 2], drawn as markers in order; those without points are left out.
        labels: of frequency and amplitude.
        title: for the top.
    """
    figure = style.new_figure(3.6)
    axis = figure.subplots()
    _draw_by_stability(axis, curve[:, 0], curve[:, 1], stable)
    for (name, points), marker in zip(marked.items(), "os^v", strict=True):
        if len(points):
            face = "none" if marker in "^v" else "black"
            axis.plot(*points.T, marker, color="black", markerfacecolor=face, markersize=5, label=name)
    axis.set_ylim(bottom=0.0)
    style.label_axis(axis.xaxis, labels[0])
    style.label_axis(axis.yaxis, labels[1])
    style.head(figure, title)
    _legend_of_all(figure, [axis])
    return figure


@style.styled
def shape_figure(branches: Sequence[BranchCurve], title: str) -> Figure:
    """Displacements at the start of the last state, and of the linear mode, each over its largest.

    Args:
        branches: a panel each.
        title: for the top.
    """
    figure = style.new_figure(0.6 + 1.9 * len(branches))
    axes = np.ravel(figure.subplots(len(branches), 1, squeeze=False, sharex=True))
    for axis, branch in zip(axes, branches, strict=True):
        for chain in range(min(branch.chains, MOST_CHAINS)):
            number, colour = np.arange(1, branch.last.shape[1] + 1), style.CHAIN_COLOURS[chain]
            line = {"color": colour, "linestyle": style.CHAIN_DASHES[chain]}
            words = f" of chain {chain + 1}" if branch.chains > 1 else ""
            last, linear = (shape / np.max(np.abs(shape)) for shape in (branch.last, branch.linear))
            axis.plot(number, last[chain], "o", markersize=3, label=f"last state{words}", **line | {"linestyle": ""})
            sign = np.sign(np.sum(branch.last * branch.linear))
            axis.plot(number, sign * linear[chain], label=f"linear mode{words}", linewidth=1.2, alpha=0.6, **line)
        axis.axhline(0.0, color="0.7", linewidth=0.6, zorder=0)
        axis.set_ylim(-1.1, 1.1)
        axis.set_ylabel("displacement / largest")
        axis.set_title(f"{branch.name}: {branch.last_state}")
    axes[-1].set_xlabel("bead")
    axes[-1].locator_params(axis="x", integer=True)
    style.letter(axes)
    style.head(figure, title)
    _legend_of_all(figure, axes)
    return figure


@style.styled
def multiplier_figure(branches: Sequence[BranchCurve], title: str) -> Figure:
    """Floquet multipliers of the last state of each branch, with the unit circle.

    Args:
        branches: a panel each.
        title: for the top.
    """
    figure = style.new_figure(3.2, 3.3 * max(1, min(3, len(branches))))
    axes = np.ravel(figure.subplots(1, len(branches), squeeze=False))
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    for axis, branch in zip(axes, branches, strict=True):
        axis.plot(np.cos(angle), np.sin(angle), color="0.7", linewidth=0.8)
        axis.plot(branch.multipliers.real, branch.multipliers.imag, "o", color=style.CHAIN_COLOURS[0], markersize=3.5)
        axis.set_aspect("equal", adjustable="datalim")
        axis.set_title(f"{branch.name}: {branch.last_state}")
        axis.set_xlabel("real part")
        axis.set_ylabel("imaginary part")
    style.letter(axes)
    style.head(figure, title)
    return figure


@style.styled
def motion_figure(branches: Sequence[BranchCurve], labels: tuple[units.Label, units.Label], title: str) -> Figure:
    """Displacements over one period of the last state of each branch, in space and time, a column for each chain.

    Args:
        branches: a row of panels each.
        labels: of displacement and time.
        title: for the top.
    """
    columns = min(max(branch.chains for branch in branches), MOST_CHAINS)
    figure = style.new_figure(0.6 + 2.2 * len(branches), 2.2 + 2.4 * columns)
    axes = figure.subplots(len(branches), columns, squeeze=False, sharey="row")
    for row, branch in zip(axes, branches, strict=True):
        largest = float(np.max(np.abs(branch.motion)))
        for chain, axis in enumerate(row):
            _, count, beads = branch.motion.shape
            image = axis.imshow(
                branch.motion[:, min(chain, count - 1)],
                origin="lower",
                aspect="auto",
                cmap="RdBu_r",
                vmin=-largest,
                vmax=largest,
                interpolation="nearest",
                extent=(0.5, beads + 0.5, 0.0, branch.period),
            )
            axis.set_title(branch.name + (f", chain {chain + 1}" if branch.chains > 1 else ""))
            axis.set_xlabel("bead")
            axis.locator_params(axis="x", integer=True)
        style.label_axis(row[0].yaxis, labels[1])
        style.label_axis(figure.colorbar(image, ax=list(row)).ax.yaxis, labels[0])
    style.letter(np.ravel(axes))
    style.head(figure, title)
    return figure


def _legend_of_all(figure: Figure, axes: Iterable[Axes]) -> None:
    """Put one legend of all panels below them, each name once."""
    entries = {}
    for axis in axes:
        handles, names = axis.get_legend_handles_labels()
        entries.update(dict(zip(names, handles, strict=True)))
    style.legend_below(figure, list(entries.values()), list(entries))
