"""The leading waves: how the chains share them over the distance run, their shape, and velocities of a few beads."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.spacetime import BeadHistory
from analysis.figures.style import (
    CHAIN_COLOURS,
    AxisUnit,
    FrameContent,
    Missing,
    axis_unit,
    broken,
    draw_chains,
    finish,
    head,
    is_narrow,
    legend_beside,
    letter,
    new_figure,
    shown_chains,
    styled,
    title,
)
from analysis.shape.exact_wave import wave_of
from analysis.shape.long_waves import period_of
from analysis.shape.waveforms import COMPARED, LARGER, Waveforms
from analysis.sharing.energies import EnergyShares
from analysis.sharing.equipartition import Sharing, runs_exact_waves
from analysis.tracking.leading_waves import Waves
from analysis.trajectory import Floats, Trajectory, along_the_way, watch
from lammps_inputs import Problem, physics

AGREED = 0.01

FEW = 3
"""Chains up to which the energy of each is drawn: more lines cannot be distinguished."""


@styled
def distance_figure(problem: Problem, shared: Sharing, energies: EnergyShares, direction: int = 1) -> Figure:
    """Leading waves over the bead that they pass, one line per chain (of many, see `shown_chains`).

    From the top, each where there is something to draw: amplitudes in units of the kick (with gaps, impulses of first
    contacts over the mass), and the bead from which on they agree to 1 %; shares of the energy in each wave, in all of
    them as measured, and as exact waves of their amplitudes would hold; shares of each whole chain (half of its
    springs' counted; two to `FEW` chains); arrival behind the chain that was kicked. Lines are interrupted at recorded
    beads at which no pulse leads, and where another pulse leads from then on.
    """
    chains, several = shown_chains(problem), problem.chains > 1
    shares = 1 < problem.chains <= FEW and bool(np.any(np.isfinite(energies.chain)))
    count = 2 + shares + several
    without = np.setdiff1d(along_the_way(problem, problem.rows.numbers), shared.bead)
    missing = Missing(without, period_of(problem.system))
    energy_beads = shared.bead[energies.place]
    figure = new_figure(0.8 + 2.0 * count)
    axes = figure.subplots(count, 1, sharex=True)
    draw_chains(axes[0], chains, *broken(*_pulse_by_pulse(shared, shared.amplitude, chains), missing))
    label = "impulse of the first\ncontact $/ mV$" if shared.of_impulses else r"peak velocity $v_\mathrm{max} / V$"
    axes[0].set_ylabel(label)
    axes[0].set_ylim(bottom=0.0)
    agreed = shared.followed.agrees_from(AGREED)
    if agreed is not None:
        axes[0].axvline(agreed, color="0.6", linewidth=0.8, zorder=0)
        axes[0].set_title(f"within 1 % from bead {agreed} on", loc="right", fontsize="small", color="0.3")
    _draw_waves(axes[1], problem, shared, energies, missing)
    if shares:
        draw_chains(axes[2], chains, *broken(energy_beads, energies.chain[:, chains], missing))
        axes[2].set_ylabel("energy of chains /\nenergy input")
        axes[2].set_ylim(0.0, 1.05)
    if several:
        unit = axis_unit(problem, "time", float(np.nanmax(np.abs(shared.lag), initial=0.0)))
        lags = _pulse_by_pulse(shared, shared.lag * unit.worth, chains, behind=True)
        draw_chains(axes[-1], chains, *broken(*lags, missing))
        axes[-1].set_ylabel(unit.label(FrameContent, "lag", f"lag behind\nchain {shared.kicked + 1},"))
    axes[-1].set_xlabel("bead" if direction > 0 else f"bead, counted from bead {problem.beads}")
    axes[-1].xaxis.get_major_locator().set_params(integer=True)
    axes[-1].set_xlim(left=max(0.0, axes[-1].get_xlim()[0]))  # there are no beads below 1
    finish(figure, problem, axes)
    return figure


def _pulse_by_pulse(
    shared: Sharing, values: Floats, chains: Sequence[int], *, behind: bool = False
) -> tuple[Floats, Floats]:
    """Beads, and values [place, chain] of some chains, whose lines end where another pulse leads.

    That is in their own chain, or with ``behind`` also in the kicked one.
    """
    bead, at = shared.bead.astype(np.float64), shared.changes
    if shared.pulse is None or len(at) == 0:
        return bead, values[:, chains]
    same = shared.pulse[at] == shared.pulse[at - 1]
    if behind:
        same = same & same[:, [shared.kicked]]
    between = np.where(same, 0.5 * (values[at - 1] + values[at]), np.nan)
    return np.insert(bead, at, 0.5 * (bead[at - 1] + bead[at])), np.insert(values, at, between, axis=0)[:, chains]


def _draw_waves(axis: Axes, problem: Problem, shared: Sharing, energies: EnergyShares, missing: Missing) -> None:
    """Draw shares of the energy input over the beads: each chain's leading wave, their sum, that of exact waves."""
    bead, chains = shared.bead[energies.place], shown_chains(problem)
    measured = bool(np.any(np.isfinite(energies.wave)))
    if measured and problem.chains > 1:
        draw_chains(axis, chains, *broken(bead, energies.wave[:, chains], missing))
    few: dict[str, Any] = {"marker": ".", "markersize": 4} if len(shared) <= FEW else {}
    lines = []
    if runs_exact_waves(problem.system):
        exact = broken(shared.bead, np.sum(shared.wave_share, axis=1), missing)
        lines += axis.plot(*exact, color="0.65", linewidth=3.0, label="sum of exact waves", **few)
    if measured:
        total = broken(bead, np.sum(energies.wave, axis=1), missing)
        lines += axis.plot(*total, color="black", linewidth=1.0, label="all pulses")
    axis.set_ylabel("energy of pulses /\nenergy input")
    axis.set_ylim(0.0, 1.05)
    place: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.0}
    axis.legend(handles=lines, ncols=2, columnspacing=1.0, fontsize="small" if is_narrow() else None, **place)


MARKERS = "os^DvP*Xp"


@styled
def shape_figure(problem: Problem, waveforms: Waveforms, beads: Sequence[int]) -> Figure:
    """Velocity of chosen beads as the waves pass them, scaled to the exact wave of their peak; differences below.

    A wave that a larger pulse overlaps at the bead is left out there.

    Args:
        problem: what was run.
        waveforms: of the leading waves.
        beads: one panel each.
    """
    exact, passages, chains = wave_of(problem.system), waveforms.passages, shown_chains(problem)
    figure = new_figure(4.4, 1.0 + 3.2 * len(beads))
    axes = figure.subplots(2, len(beads), sharex=True, squeeze=False, height_ratios=(2.2, 1.0))
    for column, bead in enumerate(beads):
        above, below = axes[:, column]
        xi = np.linspace(-COMPARED, COMPARED, 241)
        above.plot(xi, exact.velocity(xi), color="black", linewidth=1.0, label="exact wave")
        below.axhline(0.0, color="black", linewidth=1.0)
        for place, chain in enumerate(chains):
            rows = np.flatnonzero((passages.chain == chain + 1) & (passages.bead == bead))
            if len(rows) == 0:
                continue
            row, peak = rows[0], passages.peak_velocity[rows[0]]
            ahead = exact.speed_at(peak) * (passages.arrival[row] - waveforms.time[row])
            inside = np.isfinite(waveforms.velocity[row]) & (np.abs(ahead) <= COMPARED)
            ahead, velocity = ahead[inside], waveforms.velocity[row, inside] / peak
            if np.max(velocity, initial=0.0) > 1.0 + LARGER:
                continue
            look = {
                "color": CHAIN_COLOURS[place % len(CHAIN_COLOURS)],
                "marker": MARKERS[place % len(MARKERS)],
                "linestyle": "none",
                "markersize": 3.5,
                "markerfacecolor": "none" if place % 2 else None,
                "markevery": (place, len(chains)),
            }
            above.plot(ahead, velocity, label=f"chain {chain + 1}", **look)
            below.plot(ahead, velocity - exact.velocity(ahead), **look)
        above.set_title(f"bead {bead}", loc="left")
        words = "" if is_narrow() else "distance ahead of the peak\n"
        below.set_xlabel(rf"{words}$c\,(t_\mathrm{{peak}} - t)$ (beads)")
        below.ticklabel_format(axis="y", scilimits=(-2, 2))
    axes[0, 0].set_ylabel(r"velocity $v / v_\mathrm{max}$")
    axes[1, 0].set_ylabel("difference from\nexact wave")
    letter(axes[0])
    head(figure, title(problem, each_chain=True))
    legend_beside(figure, *axes[0, -1].get_legend_handles_labels(), handletextpad=0.3)
    return figure


def response_of(problem: Problem, blocks: Iterable[Trajectory], beads: Sequence[int], waves: Waves) -> Figure:
    """Velocity of some beads over time, and the passage of the leading pulse; see `response_figure`.

    Args:
        problem: what was run.
        blocks: consecutive frames, with velocities [frame, chain, bead] in units of V.
        beads: numbers of the beads.
        waves: leading pulses, with arrivals in units of T.

    Returns:
        The figure, of matplotlib.

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 30.0}).problem()
        >>> frames = engine.run(problem)
        >>> waves = Survey(problem, frames.blocks, "maximum").waves
        >>> len(response_of(problem, frames.blocks(), (5, 10), waves).axes)  # two for each bead
        4
    """
    return response_figure(watch(BeadHistory(problem, beads), blocks), waves)


@styled
def response_figure(data: BeadHistory, waves: Waves | None = None) -> Figure:
    """Velocity of chosen beads over time, all chains in one row per bead (the paper's Figs 2, 4 and 6).

    Left over the whole run; right the passage of the leading pulse of the kicked chain, over the time after its
    arrival. Beads that have not moved are named in the title, and not drawn.

    Args:
        data: velocities of the beads.
        waves: leading pulses at beads; without them, or where none has a bead of the kicked chain, there is no right
            column.
    """
    problem, velocities, beads = data.problem, data.velocity, data.beads.tolist()
    size = np.abs(np.nan_to_num(velocities)).max(axis=1, initial=0.0)  # [frame, bead]
    moved = size.max(axis=0, initial=0.0) > STILL
    drawn: list[int] = np.flatnonzero(moved).tolist() or [0]
    time = axis_unit(problem, "time", data.time[-1])
    velocity = axis_unit(problem, "velocity", float(size.max(initial=0.0)))
    arrivals = {} if waves is None else _arrivals(waves, problem)
    arrivals = {number: arrivals[beads[number]] for number in drawn if beads[number] in arrivals}
    figure = new_figure(max(2.8, 1.0 + 1.9 * len(drawn)))
    columns: dict[str, Any] = {"width_ratios": (1.5 if is_narrow() else 2.0, 1.0)} if arrivals else {}
    axes = figure.subplots(len(drawn), 1 + bool(arrivals), sharex="col", sharey="row", squeeze=False, **columns)
    spans = {number: passage(data.time, size[:, number], arrival) for number, arrival in arrivals.items()}
    close = axis_unit(problem, "time", max((high - low for low, high in spans.values()), default=1.0))
    for panels, number in zip(axes, drawn, strict=True):
        curves = velocities[:, :, number] * velocity.worth
        draw_chains(panels[0], data.chains, data.time * time.worth, curves)
        panels[0].set_title(f"bead {beads[number]}", loc="left")
        panels[0].set_ylabel(velocity.label(FrameContent, "velocity"))
        if number in arrivals:
            inside = (data.time >= spans[number][0]) & (data.time <= spans[number][1])
            after = (data.time[inside] - arrivals[number]) * close.worth
            draw_chains(panels[1], data.chains, after, curves[inside])
            panels[1].set_title(time_title(problem, "arrival", arrivals[number], time), loc="left")
        elif arrivals:
            panels[1].remove()
    axes[-1, 0].set_xlabel(time.label(FrameContent, "time"))
    if arrivals:
        lowest = axes[drawn.index(max(arrivals)), 1]
        kicked = f"in chain {_kicked(problem)} " if problem.chains > 1 else ""
        lowest.set_xlabel(f"time after arrival\n{kicked}({close.symbol})")
        lowest.xaxis.set_tick_params(labelbottom=True)
    still = [str(bead) for bead, moves in zip(beads, moved, strict=True) if not moves]
    which = f"bead{'s' * (len(still) > 1)} {', '.join(still)} {'have' if len(still) > 1 else 'has'} not moved"
    finish(figure, problem, figure.axes, until=data.until, note=f"\n{which}" if still else "")
    return figure


def _arrivals(waves: Waves, problem: Problem) -> dict[int, float]:
    """Bead -> arrival of the leading pulse of the kicked chain, where it is defined."""
    kicked = waves.of_chain(_kicked(problem))
    defined = np.isfinite(kicked.arrival)
    return dict(zip(kicked.bead[defined].tolist(), kicked.arrival[defined].tolist(), strict=True))


def _kicked(problem: Problem) -> int:
    """Number of the chain with the largest excitation."""
    return physics.largest_excitation(problem.system)[0]


STILL = 1e-9
"""Velocity, in units of V, below which a bead has not moved."""

_CLOSE = 0.1
"""Share of its largest velocity above which a bead counts as being passed."""

MOST_PULSES = 3

_MARGIN = 2.0
"""Time shown before and after a passage at least, in units of T."""


_LONGEST = 3.0
"""Time shown at most after a bead has slowed to half its velocity at the peak, in that shown before the peak."""


def passage(time: Floats, size: Floats, peak: float) -> tuple[float, float]:
    """Times, in units of T, between which a passage is shown: around a peak until the size is small, with a margin.

    Args:
        time: [frame] in units of T.
        size: [frame] largest magnitude of the velocities at each time.
        peak: time of the peak.

    Returns:
        First and last time.
    """
    top = int(np.argmin(np.abs(time - peak)))
    slow = np.flatnonzero(size <= _CLOSE * size[top])
    half = np.flatnonzero(size <= 0.5 * size[top])
    first, last = slow[slow < top], slow[slow > top]
    low = float(time[first[-1]] if len(first) else time[0])
    high = float(time[last[0]] if len(last) else time[-1])
    slowed = half[half > top]
    if len(slowed):  # else the record ends before
        high = min(high, float(time[slowed[0]]) + _LONGEST * (peak - low))
    margin = max(_MARGIN, 0.3 * (high - low))
    return low - margin, high + margin


def pulses(time: Floats, size: Floats) -> list[tuple[float, float, float]]:
    """The passages of the largest pulses: times of peaks and of the ends around them, at most `MOST_PULSES`, in order.

    Times and sizes are [frame], in units of T and of any kind. A pulse is as large as a tenth of the largest one, has
    its peak within the record, and its passage takes less than half of the whole time.
    """
    highest = (size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:]) & (size[1:-1] > _CLOSE * np.max(size))
    peaks = np.flatnonzero(highest) + 1
    passages: list[tuple[float, float, float]] = []
    for top in peaks[np.argsort(-size[peaks], kind="stable")]:
        peak = float(time[top])
        if len(passages) < MOST_PULSES and not any(low <= peak <= high for _, low, high in passages):
            passages.append((peak, *passage(time, size, peak)))
    longest = 0.5 * (time[-1] - time[0])
    return sorted((peak, low, high) for peak, low, high in passages if high - low < longest)


def time_title(problem: Problem, event: str, time: float, unit: AxisUnit) -> str:
    """Text over a panel: the event from which its axis of time counts, and when it is."""
    digits = f"{time * unit.worth:#.4g}".rstrip(".")
    return f"{event} {digits}{f' {unit.symbol}' if problem.scale.si else ''}"
