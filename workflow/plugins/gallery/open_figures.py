"""Figures of the entries on the paper's open question."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from granchain.parts import style
from workflow.plugins.gallery import row_map
from workflow.plugins.gallery.gapped_pairs import MeasuredMap, Shared
from workflow.plugins.gallery.touching_arrays import Levelled


@style.styled
def decay_figure(measured: Sequence[MeasuredMap]) -> Figure:
    """Decay from row to row of a difference of two gapped chains, over the coupling.

    Args:
        measured: maps of runs.
    """
    figure = style.new_figure(3.6, 6.4)
    axis = figure.subplots()
    kappa = np.geomspace(2e-3, 4.0, 61)
    axis.plot(kappa, [row_map.typical_decay(2.0 * value) for value in kappa], label="integrated map, any gap")
    axis.plot(kappa, row_map.weak_decay(2.0 * kappa), "--", color="0.45", label=r"$\frac{2}{45} (\omega \tau)^2$")
    axis.plot(
        [0.5 * value.stiffness for value in measured],
        [-0.5 * math.log(value.recurrence.determinant) for value in measured],
        "o",
        color=style.CHAIN_COLOURS[1],
        markersize=3.5,
        label="runs",
    )
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel(r"coupling $\kappa V_s^{-0.4}$")
    axis.set_ylabel("decay from row to row")
    style.label_log_axis(axis.xaxis)
    style.label_log_axis(axis.yaxis)
    axis.legend()
    return figure


@style.styled
def map_figure(cells: Sequence[Shared], agree: float) -> Figure:
    """Rows until impulses agree, and amplitude, over the gap, a curve for each coupling.

    Args:
        cells: of the map.
        agree: relative difference up to which impulses agree.
    """
    figure = style.new_figure(5.4, 6.4)
    rows, amplitude = figure.subplots(2, 1, sharex=True)
    for place, kappa in enumerate(sorted({cell.kappa for cell in cells})):
        chosen = [cell for cell in cells if cell.kappa == kappa]
        theta = [cell.theta for cell in chosen]
        look = {
            "color": style.CHAIN_COLOURS[place],
            "marker": "o^sDv"[place % 5],
            "markersize": 3.0,
            "linewidth": 0.8,
            "label": rf"$\kappa$ = {kappa:g}",
        }
        first = [cell.within(agree) for cell in chosen]
        rows.plot(theta, [math.nan if row is None else row for row in first], **look)
        amplitude.plot(theta, [cell.amplitude for cell in chosen], **look)
    rows.set_yscale("log")
    style.label_log_axis(rows.yaxis)
    rows.set_ylabel(f"rows until impulses agree to {100.0 * agree:g} %")
    amplitude.set_ylabel(r"amplitude $V_s / V$")
    amplitude.set_xlabel(r"gap $\theta = \omega D / V$")
    handles, labels = rows.get_legend_handles_labels()
    style.letter(figure.axes)
    style.legend_below(figure, handles, labels)
    return figure


@style.styled
def settled_figure(cells: Sequence[Shared]) -> Figure:
    """Settled pulses over gap and coupling in units of their speed, on the ranges where they would be unstable.

    Args:
        cells: that agree.
    """
    figure = style.new_figure(3.8, 6.4)
    axis = figure.subplots()
    kappa = np.geomspace(0.02, 0.5 * row_map.stable_at_any_gap(), 80)
    tongues = [row_map.tongue(2.0 * value) for value in kappa]
    shift, width = (np.array(values) for values in zip(*((t.shift, t.half_width) for t in tongues), strict=True))
    last = max(cell.at_speed[0] for cell in cells)
    for number in range(1, math.ceil(last / math.pi) + 1):
        middle = number * math.pi - shift
        label = "unstable" if number == 1 else None
        axis.fill_betweenx(kappa, middle - width, middle + width, color="0.75", linewidth=0.0, label=label)
    border = np.sqrt(2.0 * np.geomspace(0.02, 5.0, 80)) * 0.5 * row_map.CONTACT
    axis.plot(border, np.geomspace(0.02, 5.0, 80), "--", color="0.45", label="contacts overlap to the left")
    points = np.array([(cell.at_speed[0], 0.5 * cell.at_speed[1]) for cell in cells])
    axis.plot(*points.T, "o", color=style.CHAIN_COLOURS[0], markersize=2.5, label="settled pulses")
    axis.set_yscale("log")
    axis.set_xlim(0.0, last + 0.5)
    axis.set_xlabel(r"$\omega D / V_s$")
    axis.set_ylabel(r"coupling $\kappa V_s^{-0.4}$")
    style.label_log_axis(axis.yaxis)
    handles, labels = axis.get_legend_handles_labels()
    style.legend_below(figure, handles, labels)
    return figure


@style.styled
def collapse_figure(cases: Sequence[Levelled], single: float) -> Figure:
    """Distance to 1 % in lengths of decay, and N times the amplitude, over the coupling of the slowest mode.

    Args:
        cases: arrays whose peaks agree.
        single: peak velocity of a single chain, in units of V.
    """
    figure = style.new_figure(5.4, 6.4)
    distance, amplitude = figure.subplots(2, 1, sharex=True)
    for place, (kind, words) in enumerate({"row": "rows", "ring": "rings", "square": "square lattices"}.items()):
        chosen = [case for case in cases if case.graph.kind == kind]
        stiffness = [case.slowest * case.kappa for case in chosen]
        lengths = [case.delayed(0.01) for case in chosen]
        ratios = [case.graph.chains * case.amplitude / single / len(case.kicked) for case in chosen]
        look = {"color": style.CHAIN_COLOURS[place], "marker": "o^s"[place], "markersize": 3.5, "linestyle": "none"}
        distance.plot(stiffness, lengths, label=words, **look)
        amplitude.plot(stiffness, ratios, label=words, **look)
    distance.axhline(-0.45, color="0.45", linewidth=0.8, label="fit")
    distance.set_xscale("log")
    style.label_log_axis(distance.xaxis)
    amplitude.set_ylim(bottom=0.0)
    distance.set_ylabel(r"distance to 1 % $\times$ decay $-$ log(spread)")
    amplitude.set_ylabel("N amplitude / single chain")
    amplitude.set_xlabel(r"coupling of the slowest mode $\mu \kappa$")
    handles, labels = distance.get_legend_handles_labels()
    style.letter(figure.axes)
    style.legend_below(figure, handles, labels)
    return figure
