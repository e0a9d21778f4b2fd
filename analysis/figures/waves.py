"""The leading waves: how the chains share them over the distance run, their shape, and velocities of a few beads."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.spacetime import BeadHistory
from analysis.figures.style import (
    CHAIN_COLOURS,
    STYLE,
    Frames,
    Unit,
    axis_unit,
    draw_chains,
    finish,
    letter,
    shown_chains,
    title,
)
from analysis.shape.exact_wave import wave_of
from analysis.shape.waveforms import COMPARED, LARGER, Waveforms
from analysis.sharing.energies import EnergyShares
from analysis.sharing.equipartition import Sharing
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact

AGREED = 0.01

FEW = 3
"""Chains up to which the energy of each is drawn: more lines cannot be distinguished."""


@mpl.rc_context(STYLE)
def distance_figure(problem: Problem, shared: Sharing, energies: EnergyShares, direction: int = 1) -> Figure:
    """Leading waves over the bead that they pass, one line per chain (of many, see `shown_chains`).

    From the top, each where there is something to draw: amplitudes in units of the kick (with gaps, impulses of first
    contacts over the mass), and the bead from which on they agree to 1%; shares of the energy in each wave, in all of
    them as measured, and as exact waves of their amplitudes would hold; shares of each whole chain (half of its
    springs' counted; two to `FEW` chains); arrival behind the chain that was kicked.
    """
    chains, several = shown_chains(problem), problem.chains > 1
    shares = 1 < problem.chains <= FEW and bool(np.any(np.isfinite(energies.chain)))
    count = 2 + shares + several
    figure = Figure(figsize=(7.0, 0.8 + 2.0 * count), layout="constrained")
    axes = figure.subplots(count, 1, sharex=True)
    draw_chains(axes[0], chains, *_broken(shared, shared.amplitude, chains))
    label = "impulse of the first\ncontact $/ mV$" if shared.of_impulses else r"peak velocity $v_\mathrm{max} / V$"
    axes[0].set_ylabel(label)
    axes[0].set_ylim(bottom=0.0)
    agreed = shared.followed.agrees_from(AGREED)
    if agreed is not None:
        axes[0].axvline(agreed, color="0.6", linewidth=0.8, zorder=0)
        axes[0].set_title(f"within 1% from bead {agreed} on", loc="right", fontsize=8, color="0.3")
    _draw_waves(axes[1], problem, shared, energies)
    if shares:
        draw_chains(axes[2], chains, shared.bead[energies.place], energies.chain[:, chains])
        axes[2].set_ylabel("energy of chains /\nenergy input")
        axes[2].set_ylim(0.0, 1.05)
    if several:
        unit = axis_unit(problem, "time", float(np.nanmax(np.abs(shared.lag), initial=0.0)))
        draw_chains(axes[-1], chains, *_broken(shared, shared.lag * unit.worth, chains, behind=True))
        axes[-1].set_ylabel(unit.label(Frames, "lag", f"lag behind chain {shared.kicked + 1},"))
    axes[-1].set_xlabel("bead" if direction > 0 else f"bead, counted from bead {problem.beads}")
    axes[-1].xaxis.get_major_locator().set_params(integer=True)
    finish(figure, problem, axes)
    return figure


def _broken(shared: Sharing, values: Floats, chains: Sequence[int], *, behind: bool = False) -> tuple[Floats, Floats]:
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


def _draw_waves(axis: Axes, problem: Problem, shared: Sharing, energies: EnergyShares) -> None:
    system = problem.system
    bead, chains = shared.bead[energies.place], shown_chains(problem)
    measured = bool(np.any(np.isfinite(energies.wave)))
    if measured and problem.chains > 1:
        draw_chains(axis, chains, bead, energies.wave[:, chains])
    few: dict[str, Any] = {"marker": ".", "markersize": 4} if len(shared) <= FEW else {}
    lines = []
    # what runs down other beads, or with gaps, is no exact wave
    if not physics.gap(system) and physics.alike(system) and system.holds(Fact.SONIC_VACUUM):
        exact = np.sum(shared.wave_share, axis=1)
        lines += axis.plot(
            shared.bead, exact, color="0.65", linewidth=3.0, label="sum of exact solitary-wave energies", **few
        )
    if measured:
        lines += axis.plot(bead, np.sum(energies.wave, axis=1), color="black", linewidth=1.0, label="all pulses")
    axis.set_ylabel("energy of pulses /\nenergy input")
    axis.set_ylim(0.0, 1.05)
    axis.legend(handles=lines, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0)


MARKERS = "os^DvP*Xp"


@mpl.rc_context(STYLE)
def shape_figure(problem: Problem, waveforms: Waveforms, beads: Sequence[int]) -> Figure:
    """Velocity of chosen beads as the waves pass them, scaled to the exact wave of their peak; differences below.

    A wave that a larger pulse overlaps at the bead is left out there.

    Args:
        problem: what was run.
        waveforms: of the leading waves.
        beads: one panel each.
    """
    exact, passages, chains = wave_of(problem.system), waveforms.passages, shown_chains(problem)
    figure = Figure(figsize=(1.0 + 3.2 * len(beads), 4.4), layout="constrained")
    axes = figure.subplots(2, len(beads), sharex=True, squeeze=False, height_ratios=(2.2, 1.0))
    for column, bead in enumerate(beads):
        above, below = axes[:, column]
        xi = np.linspace(-COMPARED, COMPARED, 241)
        above.plot(xi, exact.velocity(xi), color="black", linewidth=1.0, label="exact wave")
        below.axhline(0.0, color="black", linewidth=1.0)
        for place, chain in enumerate(chains):
            found = np.flatnonzero((passages.chain == chain + 1) & (passages.bead == bead))
            if len(found) == 0:
                continue
            row, peak = found[0], passages.peak_velocity[found[0]]
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
        if column == len(beads) - 1:
            above.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), handletextpad=0.3)
        below.set_xlabel("distance ahead of the peak\n" r"$c\,(t_\mathrm{peak} - t)$ (beads)")
        below.ticklabel_format(axis="y", scilimits=(-2, 2))
    axes[0, 0].set_ylabel(r"velocity $v / v_\mathrm{max}$")
    axes[1, 0].set_ylabel("difference from\nexact wave")
    letter(axes[0])
    figure.suptitle(title(problem, each_chain=True))
    return figure


@mpl.rc_context(STYLE)
def response_figure(data: BeadHistory) -> Figure:
    """Velocity of chosen beads over time, all chains in one row per bead (the paper's Figs 2, 4 and 6).

    Left over the whole run, right the passage of the fastest pulse, its time from the instant when the bead is fastest
    in any chain. Beads that have not moved are named below, and not drawn.
    """
    problem, velocities, beads = data.problem, data.velocity, data.beads.tolist()
    size = np.abs(np.nan_to_num(velocities)).max(axis=1, initial=0.0)  # [frame, bead]
    moved = size.max(axis=0, initial=0.0) > STILL
    drawn: list[int] = np.flatnonzero(moved).tolist() or [0]
    time = axis_unit(problem, "time", data.time[-1])
    velocity = axis_unit(problem, "velocity", float(size.max(initial=0.0)))
    figure = Figure(figsize=(7.0, 1.2 + 1.9 * len(drawn)), layout="constrained")
    axes = figure.subplots(len(drawn), 2, sharex="col", sharey="row", squeeze=False, width_ratios=(2.0, 1.0))
    spans = [passage(data.time, size[:, number], int(np.argmax(size[:, number]))) for number in drawn]
    close = axis_unit(problem, "time", max(high - low for _, low, high in spans))
    for (whole, near), number, (middle, low, high) in zip(axes, drawn, spans, strict=True):
        curves = velocities[:, :, number] * velocity.worth
        draw_chains(whole, data.chains, data.time * time.worth, curves)
        inside = (data.time >= low) & (data.time <= high)
        draw_chains(near, data.chains, (data.time[inside] - middle) * close.worth, curves[inside])
        near.set_title(peak_title(problem, middle, time), loc="left")
        whole.set_title(f"bead {beads[number]}", loc="left")
        whole.set_ylabel(velocity.label(Frames, "velocity"))
    axes[-1, 0].set_xlabel(time.label(Frames, "time"))
    axes[-1, 1].set_xlabel(after_peak(close))
    still = [str(bead) for bead, moves in zip(beads, moved, strict=True) if not moves]
    which = f"bead{'s' * (len(still) > 1)} {', '.join(still)} {'have' if len(still) > 1 else 'has'} not moved"
    finish(figure, problem, axes.flat, until=data.until, note=f"\n{which}" if still else "")
    return figure


STILL = 1e-9
"""Velocity, in units of V, below which a bead has not moved."""

_CLOSE = 0.1
"""Share of its largest velocity above which a bead counts as being passed."""

MOST_PULSES = 3

_MARGIN = 2.0
"""Time shown before and after a passage at least, in units of T."""


def passage(time: Floats, size: Floats, top: int) -> tuple[float, float, float]:
    """The time of a peak in a frame, and of the ends of the time around it in which a size [frame] is large."""
    slow = np.flatnonzero(size <= _CLOSE * size[top])
    first, last = slow[slow < top], slow[slow > top]
    low = time[first[-1]] if len(first) else time[0]
    high = time[last[0]] if len(last) else time[-1]
    margin = max(_MARGIN, 0.3 * float(high - low))
    return float(time[top]), float(low) - margin, float(high) + margin


def pulses(time: Floats, size: Floats) -> list[tuple[float, float, float]]:
    """The passages of the largest pulses, at most `MOST_PULSES`, in their order in time.

    A pulse is as large as a tenth of the largest one, and its passage takes less than half of the whole time.
    """
    around = np.pad(size, 1)
    peaks = np.flatnonzero((size >= around[:-2]) & (size > around[2:]) & (size > _CLOSE * np.max(size)))
    found: list[tuple[float, float, float]] = []
    for top in peaks[np.argsort(-size[peaks], kind="stable")]:
        if len(found) < MOST_PULSES and not any(low <= time[top] <= high for _, low, high in found):
            found.append(passage(time, size, top))
    return sorted(one for one in found if one[2] - one[1] < 0.5 * (time[-1] - time[0]))


def peak_title(problem: Problem, peak: float, unit: Unit) -> str:
    """Over a panel: the time of its peak."""
    return rf"$t_\mathrm{{peak}}$ = {peak * unit.worth:.4g}{f' {unit.symbol}' if problem.scale.si else ''}"


def after_peak(unit: Unit) -> str:
    """The axis of time of such a panel."""
    return rf"$t - t_\mathrm{{peak}}$ ({unit.symbol})"
