"""Plots of what only some runs have: energy budget over time, spectra of beads, dispersion."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from bokeh.models import (
    BasicTicker,
    ColorBar,
    ColumnDataSource,
    CustomJSTickFormatter,
    FixedTicker,
    HoverTool,
    LinearColorMapper,
    LogTickFormatter,
    Range1d,
    Span,
)

from granchain.parts import Floats, Problem
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.plots import (
    MARKS,
    TICK,
    add_legend,
    chain_name,
    graph,
    largest,
    look,
    map_palette,
    mark,
    number,
)
from workflow.plugins.pages.save_data import add_tool_of_curves, add_tool_of_image
from workflow.plugins.pages.units import PageUnit, Units, page_unit

_MOST_PIXELS = 400
"""Rows and columns of a map of power at most; of more, each pixel has the largest of some."""

_INPUT = {"line_color": "#888888", "line_width": 3.5, "line_alpha": 0.7}
"""Look of the energy input, behind the other lines."""


def plots_of(
    problem: Problem, part: Thinned, measurements: Mapping[str, Any], time_range: Range1d, units: Units
) -> list[Any]:
    """Plots of those measurements that have one on the page, in their order.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        measurements: of the run, by their keys.
        time_range: shared by plots over time.
        units: of the page.
    """
    plots = []
    for key, measurement in measurements.items():
        if not measurement.drawable:
            continue
        if key == "budget":
            plots.append(_budget(measurement, time_range, units))
        elif key == "spectra":
            plots.append(_spectra(problem, part, measurement.spectra))
        elif key == "dispersion":
            plots.append(_dispersion(problem, measurement.map))
    return plots


def _budget(budget: Any, time_range: Range1d, units: Units) -> Any:
    """Energy input, stored and dissipated, by where and by source, over time, of the measurement ``budget``."""
    problem, account, curves = budget.problem, budget.values, budget.curves()
    unit = page_unit(problem, "energy", account.most)
    units = {**units, "energy": unit}
    time = units["time"]
    mean = f", mean over {curves.mean_over * time.worth:.2g}{time.behind}" if curves.mean_over else ""
    plot = graph(f"energy budget{mean}", "budget", units, "energy", time_range)
    instants = account.time * time.worth
    items = [("energy input", [plot.line(instants, curves.energy_input * unit.worth, **_INPUT)])]
    for place, (name, values) in enumerate(curves.by_words.items()):
        items.append((name, [plot.line(instants, values * unit.worth, **look(place))]))
    _add_hover(plot, items, {"time": ("x", time), "energy": ("y", unit)})
    add_legend(plot, items)
    add_tool_of_curves(plot, problem.name)
    return plot


def _spectra(problem: Problem, part: Thinned, spectra: Any) -> Any:
    """Amplitude of the velocity over frequency; colour and dashes are the chain's, the mark is the bead's."""
    top = float(np.max(spectra.amplitude, initial=1e-30))
    velocity, cycles = (
        page_unit(problem, "velocity", top),
        page_unit(problem, "cycles", float(np.max(spectra.frequency))),
    )
    ends = Range1d(float(spectra.frequency[0]) * cycles.worth, float(spectra.frequency[-1]) * cycles.worth)
    ends.bounds = "auto"
    plot = graph("spectra of the velocities", "spectra", {"velocity": velocity}, "velocity", ends, "", "log")
    plot.xaxis.axis_label = cycles.label("frequency", "f")
    plot.xaxis.ticker = BasicTicker()
    plot.yaxis.axis_label = velocity.label("amplitude", "\\hat v")
    plot.yaxis.formatter = LogTickFormatter()
    plot.y_range = Range1d(spectra.DEEPEST * top * velocity.worth, 2.0 * top * velocity.worth)
    several, items = len(part.chains) > 1, []
    frequency = spectra.frequency * cycles.worth
    for bead_number, bead in enumerate(spectra.beads[: len(MARKS)]):
        for place, chain in enumerate(part.chains):
            values = spectra.amplitude[:, chain - 1, bead_number] * velocity.worth
            style = look(place if several else bead_number)
            drawn = [plot.line(frequency, values, name=chain_name(chain), **style)]
            if several:
                points = ColumnDataSource(data=largest(frequency, values))
                drawn.append(mark(plot, points, place, bead_number))
                drawn[-1].name = chain_name(chain)
            items.append((f"bead {bead}, {chain_name(chain)}", drawn))
    for drive in spectra.drive:
        line = Span(dimension="height", location=drive * cycles.worth, line_color="#888888", line_dash="dotted")
        plot.add_layout(line)
    if spectra.drive.size:
        plot.title.text += "; dotted: frequency of the drive"
    _add_hover(plot, items, {"frequency": ("x", cycles), "velocity": ("y", velocity)})
    add_legend(plot, items)
    add_tool_of_curves(plot, problem.name)
    return plot


def _dispersion(problem: Problem, spectrum: Any) -> Any:
    """Power over wavenumber and frequency, with the exact branches and the edges of their bands."""
    top = spectrum.top
    unit = page_unit(problem, "frequency", top)
    power, (left, right), (bottom, end) = spectrum.shown_power()
    power = _coarser(power)
    plot = graph("dispersion", "dispersion", {"velocity": unit}, "velocity", Range1d(-math.pi, math.pi), "")
    if problem.chains > 1:
        plot.title.text += f", {chain_name(spectrum.chain)}"
    plot.xaxis.axis_label = PageUnit(1.0, "rad/bead").label("wavenumber", "q")
    plot.yaxis.axis_label = unit.label("angular frequency", "\\omega")
    plot.x_range.bounds = (-math.pi, math.pi)
    plot.y_range = Range1d(0.0, top * unit.worth, bounds=(0.0, top * unit.worth))
    names = {-math.pi: "-\N{GREEK SMALL LETTER PI}", 0.0: "0", math.pi: "\N{GREEK SMALL LETTER PI}"}
    names |= {sign * math.pi / 2: f"{'-' if sign < 0 else ''}\N{GREEK SMALL LETTER PI}/2" for sign in (-1, 1)}
    plot.xaxis.ticker = FixedTicker(ticks=sorted(names))
    plot.xaxis.major_label_overrides = names
    plot.xaxis.formatter = CustomJSTickFormatter(code=TICK)
    colours = LinearColorMapper(palette=map_palette("magma"), low=-spectrum.DECADES, high=0.0)
    box = {"x": [left], "y": [bottom * unit.worth], "dw": [right - left], "dh": [(end - bottom) * unit.worth]}
    image = ColumnDataSource({"power": [power.astype(np.float32)], **box})
    drawn = plot.image("power", x="x", y="y", dw="dw", dh="dh", source=image, color_mapper=colours)
    tips = [("wavenumber", "$x"), ("frequency", "$y"), ("log10 of power / maximum", "@power")]
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips))
    plot.add_layout(ColorBar(color_mapper=colours, title="log10 (power / maximum)", width=10), "right")
    plot.grid.visible = False
    heads = [plot.xaxis.axis_label, plot.yaxis.axis_label, "log10 (power / maximum)"]
    add_tool_of_image(plot, problem.name, image, "power", heads)
    wavenumber = np.linspace(-math.pi, math.pi, 401)
    branches = spectrum.cell.branches(wavenumber).T * unit.worth
    lines = [plot.line(wavenumber, branch, line_color="#00acc1", line_dash="dashed") for branch in branches]
    edges = np.unique(spectrum.cell.bands().round(12)) * unit.worth
    style = {"line_color": "#9e9e9e", "line_dash": "dotted"}
    borders = [plot.line([-math.pi, math.pi], [edge, edge], **style) for edge in edges]
    add_legend(plot, [("exact branches (dashed)", lines), ("edges of bands (dotted)", borders)])
    return plot


def _coarser(values: Floats) -> Floats:
    """Largest values of blocks of values [row, column], at most `_MOST_PIXELS` of them in each direction."""
    for axis in (0, 1):
        starts = np.unique(np.linspace(0, values.shape[axis], min(values.shape[axis], _MOST_PIXELS), endpoint=False))
        values = np.maximum.reduceat(values, starts.astype(int), axis=axis)
    return values


def _add_hover(plot: Any, items: list[tuple[str, list[Any]]], columns: dict[str, tuple[str, PageUnit]]) -> None:
    """Let a cursor over lines say their numbers, by words: column and unit."""
    tips = [(words, f"@{column}{{custom}}") for words, (column, _) in columns.items()]
    formatters = {f"@{column}": number(unit) for column, unit in columns.values()}
    lines = [drawn[0] for _, drawn in items]
    plot.add_tools(HoverTool(renderers=lines, tooltips=tips, formatters=formatters))
