"""Plots of what only some runs have: energy budget over time, spectra of beads, dispersion."""

import math
from collections.abc import Iterable
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

from analysis.conservation import Account
from analysis.figures.energy import averaged, budget_curves
from analysis.figures.spectra import DEEPEST
from analysis.figures.style import AxisUnit, axis_unit
from analysis.gauges.spectra import SpectrumTable, VelocitySpectra
from analysis.quantity import declared
from analysis.trajectory import Floats
from lammps_inputs import Problem
from lammps_inputs.units import REDUCED, Label
from workflow.measures.base import Measurement
from workflow.measures.energy import BudgetMeasurement
from workflow.measures.gauges import SpectrumMeasurement
from workflow.plugins.pages.downsample import Thinned, Units
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
from workflow.plugins.sound.dispersion import DECADES, Branches, Map
from workflow.plugins.sound.measure import DispersionMeasurement

_MOST_PIXELS = 400
"""Rows and columns of a map of power at most; of more, each pixel has the largest of some."""

_INPUT = {"line_color": "#888888", "line_width": 3.5, "line_alpha": 0.7}
"""Look of the energy input, behind the other lines."""


def plots_of(
    problem: Problem, part: Thinned, measurements: Iterable[Measurement], time_range: Range1d, units: Units
) -> list[Any]:
    """Plots of those measurements that have one on the page, in their order.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        measurements: of the run.
        time_range: shared by plots over time.
        units: of the page.
    """
    plots = []
    for measurement in measurements:
        if not measurement.drawable:
            continue
        if isinstance(measurement, BudgetMeasurement):
            plots.append(_budget(problem, measurement.values, time_range, units))
        elif isinstance(measurement, SpectrumMeasurement):
            plots.append(_spectra(problem, part, measurement.spectra))
        elif isinstance(measurement, DispersionMeasurement) and measurement.map is not None:
            plots.append(_dispersion(problem, measurement.map))
    return plots


def _budget(problem: Problem, account: Account, time_range: Range1d, units: Units) -> Any:
    """Energy input, stored and dissipated, by where and by source, over time."""
    unit = _unit(problem, "energy", account.most)
    units = {**units, "energy": unit}
    curves = budget_curves(account)
    width = averaged(account.time, curves.width, units["time"]).lstrip(",").replace("\n", " ")
    plot = graph(f"energy budget{',' if width else ''}{width}", "budget", units, "energy", time_range)
    time = account.time * units["time"].worth
    items = [("energy input", [plot.line(time, curves.energy_input * unit.worth, **_INPUT)])]
    for place, (name, values) in enumerate(curves.by_words.items()):
        items.append((name, [plot.line(time, values * unit.worth, **look(place))]))
    _add_hover(plot, items, {"time": ("x", units["time"]), "energy": ("y", unit)})
    add_legend(plot, items)
    add_tool_of_curves(plot, problem.name)
    return plot


def _spectra(problem: Problem, part: Thinned, spectra: VelocitySpectra) -> Any:
    """Amplitude of the velocity over frequency; colour and dashes are the chain's, the mark is the bead's."""
    top = float(np.max(spectra.amplitude, initial=1e-30))
    velocity, cycles = _unit(problem, "velocity", top), _unit(problem, "cycles", float(np.max(spectra.frequency)))
    ends = Range1d(float(spectra.frequency[0]) * cycles.worth, float(spectra.frequency[-1]) * cycles.worth)
    ends.bounds = "auto"
    plot = graph("spectra of the velocities", "spectra", {"velocity": velocity}, "velocity", ends, "", "log")
    plot.xaxis.axis_label = _label("frequency", SpectrumTable, "frequency", cycles)
    plot.xaxis.ticker = BasicTicker()
    plot.yaxis.axis_label = _label("amplitude", SpectrumTable, "amplitude", velocity)
    plot.yaxis.formatter = LogTickFormatter()
    plot.y_range = Range1d(DEEPEST * top * velocity.worth, 2.0 * top * velocity.worth)
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


def _dispersion(problem: Problem, spectrum: Map) -> Any:
    """Power over wavenumber and frequency, with the exact branches and the edges of their bands."""
    top = spectrum.highest_frequency
    unit = _unit(problem, "frequency", top)
    power, (left, right), (bottom, end) = spectrum.shown_power()
    power = _coarser(power)
    plot = graph("dispersion", "dispersion", {"velocity": unit}, "velocity", Range1d(-math.pi, math.pi), "")
    if problem.chains > 1:
        plot.title.text += f", {chain_name(spectrum.chain)}"
    plot.xaxis.axis_label = _label("wavenumber", Branches, "wavenumber", AxisUnit(1.0, "rad/bead"))
    plot.yaxis.axis_label = _label("angular frequency", Branches, "frequency", unit)
    plot.x_range.bounds = (-math.pi, math.pi)
    plot.y_range = Range1d(0.0, top * unit.worth, bounds=(0.0, top * unit.worth))
    names = {-math.pi: "-\N{GREEK SMALL LETTER PI}", 0.0: "0", math.pi: "\N{GREEK SMALL LETTER PI}"}
    names |= {sign * math.pi / 2: f"{'-' if sign < 0 else ''}\N{GREEK SMALL LETTER PI}/2" for sign in (-1, 1)}
    plot.xaxis.ticker = FixedTicker(ticks=sorted(names))
    plot.xaxis.major_label_overrides = names
    plot.xaxis.formatter = CustomJSTickFormatter(code=TICK)
    colours = LinearColorMapper(palette=map_palette("magma"), low=-DECADES, high=0.0)
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


def _add_hover(plot: Any, items: list[tuple[str, list[Any]]], columns: dict[str, tuple[str, AxisUnit]]) -> None:
    """Let a cursor over lines say their numbers, by words: column and unit."""
    tips = [(words, f"@{column}{{custom}}") for words, (column, _) in columns.items()]
    formatters = {f"@{column}": number(unit) for column, unit in columns.values()}
    lines = [drawn[0] for _, drawn in items]
    plot.add_tools(HoverTool(renderers=lines, tooltips=tips, formatters=formatters))


def _unit(problem: Problem, kind: str, size: float) -> AxisUnit:
    """Unit of a quantity up to a size, as those of the page."""
    if not problem.scale.si:
        return AxisUnit(float(problem.scale.measured(1.0, kind)), "")
    return axis_unit(problem, kind, size)


def _label(words: str, kind: type, name: str, unit: AxisUnit) -> str:
    """Words, symbol as a type declares it, and unit."""
    return Label(words, declared(kind)[name][0].symbol, unit.symbol or REDUCED).plain
