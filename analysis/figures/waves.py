"""The leading waves: how the chains share them over the distance run, their shape, and velocities of a few beads."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analysis.figures.panels import (
    BEAD,
    Axis,
    AxisUnit,
    Curve,
    FrameContent,
    Marks,
    Missing,
    Panel,
    Sheet,
    axis_unit,
    broken,
    curves_of,
    shown_chains,
    title,
)
from analysis.figures.spacetime import BeadHistory
from analysis.shape.exact_wave import wave_of
from analysis.shape.long_waves import period_of
from analysis.shape.waveforms import COMPARED, LARGER, Waveforms
from analysis.sharing.energies import EnergyShares
from analysis.sharing.equipartition import Sharing, runs_exact_waves
from analysis.tracking.leading_waves import Waves
from analysis.trajectory import Floats, along_the_way
from lammps_inputs import Problem, physics
from lammps_inputs.units import ENERGY_INPUT, Label

AGREED = 0.01

FEW = 3
"""Chains up to which the energy of each is drawn: more lines cannot be distinguished."""


def distance_sheet(problem: Problem, shared: Sharing, energies: EnergyShares, direction: int = 1) -> Sheet:
    """Leading waves over the bead that they pass, one line per chain (of many, see `shown_chains`).

    From the top, each where there is something to show: amplitudes in units of the kick (with gaps, impulses of first
    contacts over the mass), and the bead from which on they agree to 1 %; shares of the energy in each wave, in all of
    them as measured, and as exact waves of their amplitudes would hold; shares of each whole chain (half of its
    springs' counted; two to `FEW` chains); arrival behind the chain that was kicked. Lines are interrupted at recorded
    beads at which no pulse leads, and where another pulse leads from then on.
    """
    chains = shown_chains(problem)
    without = np.setdiff1d(along_the_way(problem, problem.rows.numbers), shared.bead)
    missing = Missing(without, period_of(problem.system))
    bead = BEAD if direction > 0 else replace(BEAD, label=Label(f"bead, counted from bead {problem.beads}"))
    amplitude = Label("peak velocity", "v_\\mathrm{max}", "V")
    if shared.of_impulses:
        amplitude = Label("impulse of the first\ncontact", "/ mV")
    curves = curves_of(chains, *broken(*_pulse_by_pulse(shared, shared.amplitude, chains), missing))
    agreed = shared.followed.agrees_from(AGREED)
    remark = ""
    marks: tuple[Marks, ...] = ()
    if agreed is not None:
        remark = f"within 1 % from bead {agreed} on"
        marks = (Marks([agreed], look={"color": "0.6", "linewidth": 0.8, "zorder": 0}),)
    shown = [Panel(bead, Axis(amplitude, ends=(0.0, None)), curves, remark=remark, marks=marks)]
    waves = _waves(problem, shared, energies, missing)
    if waves:
        shown.append(Panel(bead, _of_input("energy of pulses /\n"), waves))
    if 1 < problem.chains <= FEW and bool(np.any(np.isfinite(energies.chain))):
        curves = curves_of(chains, *broken(shared.bead[energies.place], energies.chain[:, chains], missing))
        shown.append(Panel(bead, _of_input("energy of chains /\n"), curves))
    if problem.chains > 1:
        unit = axis_unit(problem, "time", float(np.nanmax(np.abs(shared.lag), initial=0.0)))
        lags = _pulse_by_pulse(shared, shared.lag * unit.worth, chains, behind=True)
        lag = unit.axis(FrameContent, "lag", f"lag behind\nchain {shared.kicked + 1},")
        shown.append(Panel(bead, lag, curves_of(chains, *broken(*lags, missing))))
    return Sheet(title(problem, each_chain=True), [[panel] for panel in shown], 0.8 + 2.0 * len(shown))


def _of_input(words: str) -> Axis:
    """Axis of shares of the energy input."""
    return Axis(Label(f"{words}{ENERGY_INPUT}"), ends=(0.0, 1.05))


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


def _waves(problem: Problem, shared: Sharing, energies: EnergyShares, missing: Missing) -> tuple[Curve, ...]:
    """Shares of the energy input over the beads: each chain's leading wave, that of exact waves, the sum."""
    bead, chains = shared.bead[energies.place], shown_chains(problem)
    few: dict[str, Any] = {"marker": ".", "markersize": 4} if len(shared) <= FEW else {}
    measured = bool(np.any(np.isfinite(energies.wave)))
    curves: list[Curve] = []
    if measured and problem.chains > 1:
        curves += curves_of(chains, *broken(bead, energies.wave[:, chains], missing))
    if runs_exact_waves(problem.system):
        exact = broken(shared.bead, np.sum(shared.wave_share, axis=1), missing)
        curves.append(Curve("sum of exact waves", *exact, look={"color": "0.65", "linewidth": 3.0, **few}))
    if measured:
        total = broken(bead, np.sum(energies.wave, axis=1), missing)
        curves.append(Curve("all pulses", *total, look={"color": "black", "linewidth": 1.0}))
    return tuple(curves)


MARKERS = "os^DvP*Xp"


def shape_sheet(problem: Problem, waveforms: Waveforms, beads: Sequence[int]) -> Sheet:
    """Velocity of chosen beads as the waves pass them, scaled to the exact wave of their peak; differences below.

    A wave that a larger pulse overlaps at the bead is left out there.

    Args:
        problem: what was run.
        waveforms: of the leading waves.
        beads: one panel each.
    """
    exact, passages, chains = wave_of(problem.system), waveforms.passages, shown_chains(problem)
    ahead_of_peak = Axis(Label("distance ahead\nof the peak\n", "c\\,(t_\\mathrm{peak} - t)", "beads"))
    velocity_axis = Axis(Label("velocity", "v / v_\\mathrm{max}"))
    difference = Axis(Label("difference from\nexact wave"))
    xi, black = np.linspace(-COMPARED, COMPARED, 241), {"color": "black", "linewidth": 1.0}
    zero = (Marks([0.0], look={**black, "zorder": 1}, level=True),)
    above, below = [], []
    for bead in beads:
        waves, differences = [Curve("exact wave", xi, exact.velocity(xi), look=black)], []
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
                "marker": MARKERS[place % len(MARKERS)],
                "linestyle": "none",
                "markersize": 3.5,
                "markerfacecolor": "none" if place % 2 else None,
                "markevery": (place, len(chains)),
            }
            waves.append(Curve(f"chain {chain + 1}", ahead, velocity, place, look))
            differences.append(replace(waves[-1], y=velocity - exact.velocity(ahead)))
        above.append(Panel(ahead_of_peak, velocity_axis, tuple(waves), f"bead {bead}"))
        below.append(Panel(ahead_of_peak, difference, tuple(differences), marks=zero))
    heading = title(problem, each_chain=True)
    return Sheet(heading, [above, below], 4.6, 1.0 + 3.2 * len(beads), heights=(2.2, 1.0))


def response_sheet(data: BeadHistory, waves: Waves | None = None) -> Sheet:
    """Velocity of chosen beads over time, all chains in one row per bead (the paper's Figs 2, 4 and 6).

    Left over the whole run; right the passage of the leading pulse of the kicked chain, over the time after its
    arrival. Beads that have not moved are named in the title, and not shown.

    Args:
        data: velocities of the beads.
        waves: leading pulses at beads; without them, or where none has a bead of the kicked chain, there is no right
            column.
    """
    problem, velocities, beads = data.problem, data.velocity, data.beads.tolist()
    size = np.abs(np.nan_to_num(velocities)).max(axis=1, initial=0.0)  # [frame, bead]
    moved = size.max(axis=0, initial=0.0) > STILL
    velocity = axis_unit(problem, "velocity", float(size.max(initial=0.0)))
    arrivals = {} if waves is None else _arrivals(waves, problem)
    traces = []
    for number in np.flatnonzero(moved).tolist() or [0]:
        arrival = arrivals.get(beads[number])
        spans = [] if arrival is None else [(arrival, *passage(data.time, size[:, number], arrival))]
        traces.append(Trace(f"bead {beads[number]}", velocities[:, :, number] * velocity.worth, spans))
    still = [str(bead) for bead, moves in zip(beads, moved, strict=True) if not moves]
    which = f"bead{'s' * (len(still) > 1)} {', '.join(still)} {'have' if len(still) > 1 else 'has'} not moved"
    kicked = f"in chain {_kicked(problem)} " if problem.chains > 1 else ""
    heading = title(problem, each_chain=True, until=data.until) + (f"\n{which}" if still else "")
    axis = velocity.axis(FrameContent, "velocity")
    events = ("arrival", f"time after arrival\n{kicked}".rstrip(" "))
    return traces_sheet(problem, heading, data.time, axis, traces, events)


@dataclass(frozen=True)
class Trace:
    """A quantity of the chains over time, and passages that are shown close up.

    Attributes:
        name: of the bead or gauge.
        values: [frame, chain] in the unit of the axis; all chains, or those that are shown.
        passages: time of the event, first and last time that is shown, in units of T.
        remark: on the right above the panel.
    """

    name: str
    values: Floats
    passages: Sequence[tuple[float, float, float]]
    remark: str = ""


def traces_sheet(
    problem: Problem, heading: str, time: Floats, y: Axis, traces: Sequence[Trace], event: tuple[str, str]
) -> Sheet:
    """A row of panels for each trace: a line for each chain that is shown, left over the run, right close up.

    Args:
        problem: what was run.
        heading: title of the figure.
        time: [frame] in units of T.
        y: axis of the values.
        traces: with values of the chains that are shown.
        event: that the time close up counts from, and words of that time.
    """
    unit, chains = axis_unit(problem, "time", float(time[-1])), shown_chains(problem)
    columns = max(len(trace.passages) for trace in traces)
    longest = max((last - first for trace in traces for _, first, last in trace.passages), default=1.0)
    near = axis_unit(problem, "time", longest)
    close = Axis(Label(event[1], unit=near.symbol), near.worth)
    rows: list[list[Panel | None]] = []
    for trace in traces:
        curves = curves_of(chains, time * unit.worth, trace.values)
        row: list[Panel | None] = [Panel(unit.axis(FrameContent, "time"), y, curves, trace.name, trace.remark)]
        for at, first, last in trace.passages:
            inside = (time >= first) & (time <= last)
            curves = curves_of(chains, (time[inside] - at) * near.worth, trace.values[inside])
            row.append(Panel(close, y, curves, time_title(event[0], at, unit)))
        rows.append([*row, *[None] * (columns - len(trace.passages))])
    widths = (2.25, *[1.0] * columns)
    height, width = max(2.8, 1.0 + 1.8 * len(rows)), 7.0 + 1.5 * max(0, columns - 1)
    return Sheet(heading, rows, height, width, same_y="row", widths=widths)


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

_MARGIN = 0.3
"""Time shown before and after a passage, over the time that it takes."""


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
    margin = _MARGIN * (high - low)
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


def time_title(event: str, time: float, unit: AxisUnit) -> str:
    """Text over a panel: the event from which its axis of time counts, and when it is."""
    return f"{event} {f'{time * unit.worth:#.4g}'.rstrip('.')}{unit.behind}"
