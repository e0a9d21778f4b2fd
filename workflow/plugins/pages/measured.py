"""Panels of a run's figures as plots of its page: curves of all panels in one plot, and the map of a dispersion."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from bokeh.models import (
    ColorBar,
    ColumnDataSource,
    CustomJSTickFormatter,
    FixedTicker,
    HoverTool,
    LinearColorMapper,
    Range1d,
    Span,
)

from granchain.parts import Floats, Problem, panels
from granchain.parts import units as labels
from workflow.plugins.pages.plots import MARKS, TICK, add_legend, graph, largest, look, map_palette, mark, number
from workflow.plugins.pages.save_data import add_tool_of_curves, add_tool_of_image
from workflow.plugins.pages.units import Units, axis_of

_MOST_PIXELS = 400
"""Rows and columns of a map of power at most; of more, each pixel has the largest of some."""

_INPUT = {"line_color": "#888888", "line_width": 3.5, "line_alpha": 0.7, "line_dash": "solid"}
"""Look of the energy input, behind the other lines."""


def curves_plot(
    title: str,
    name: str,
    shown: Sequence[panels.Panel],
    x_range: Range1d,
    *,
    x: panels.Axis | None = None,
    looks: Mapping[str, Mapping[str, Any]] | None = None,
) -> Any:
    """Curves of panels with the same axes in one plot.

    Colour and dashes are the chain's and the mark is the panel's, or all are the panel's where there is one chain.

    Args:
        title: above it.
        name: of the file that is saved.
        shown: panels; of more than there are marks, the first.
        x_range: shared by plots over the same quantity.
        x: axis of the page in place of that of the panels, whose unit may be another.
        looks: of curves that are no chain's, by their names.
    """
    first, looks = shown[0], looks or {}
    over = x or first.x
    plot = graph(title, name, over, first.y, x_range)
    several_chains = len({curve.place for panel in shown for curve in panel.curves} - {None}) > 1
    items, lines = [], []
    for place, panel in enumerate(shown[: len(MARKS)]):
        for curve in panel.curves:
            along, chain = np.asarray(curve.x * (over.worth / first.x.worth)), curve.place or 0
            style = {"name": curve.name, **look(chain if several_chains else place), **looks.get(curve.name, {})}
            drawn = [plot.line("x", "y", source=ColumnDataSource({"x": along, "y": curve.y}), **style)]
            lonely = panels.alone(curve.y)
            if np.any(lonely):
                points = ColumnDataSource({"x": along[lonely], "y": curve.y[lonely]})
                drawn.append(plot.scatter("x", "y", source=points, size=4, color=style["line_color"], name=curve.name))
            if several_chains and len(shown) > 1:
                drawn.append(mark(plot, ColumnDataSource(largest(along, curve.y)), chain, place))
                drawn[-1].name = curve.name
            lines += drawn[:1] if curve.place is not None else []
            items.append((f"{panel.title}, {curve.name}" if panel.title else curve.name, drawn))
    for marks in first.marks:
        for at in marks.places:
            plot.add_layout(Span(dimension="height", location=at, line_color="#888888", line_dash="dotted"))
        plot.title.text += f"; dotted: {marks.name}" if len(marks.places) else ""
    tips, formatters = [], {}
    for field, label in (("x", over.label), ("y", first.y.label)):
        tips.append((label.words, f"@{field}{{custom}}"))
        formatters[f"@{field}"] = number(panels.AxisUnit(1.0, label.unit or labels.REDUCED))
    plot.add_tools(HoverTool(renderers=lines, tooltips=tips, formatters=formatters))
    add_legend(plot, items)
    return plot


def plots_of(problem: Problem, measurements: Mapping[str, Any], time_range: Range1d, units: Units) -> list[Any]:
    """Plots of those measurements that have one on the page, in their order.

    Args:
        problem: what was run.
        measurements: of the run, by their keys.
        time_range: shared by plots over time.
        units: of the page.
    """
    plots = []
    for key, measurement in measurements.items():
        sheet = measurement.sheet() if key in ("budget", "spectra", "dispersion") else None
        if sheet is None:
            continue
        if key == "dispersion":
            plots.append(_dispersion(problem, sheet))
            continue
        plots.append(_budget(sheet, time_range, units) if key == "budget" else _spectra(sheet))
        add_tool_of_curves(plots[-1], problem.name)
    return plots


def _budget(sheet: panels.Sheet, time_range: Range1d, units: Units) -> Any:
    """Energy input, stored and dissipated, by where and by source, over time."""
    (panel,) = sheet.panels
    layers = [replace(layer, place=place) for place, layer in enumerate(panel.layers)]
    energy_input = [replace(curve, place=0) for curve in panel.curves]
    title = ", ".join(filter(None, ["energy budget", panel.remark]))
    shown = [replace(panel, curves=(*energy_input, *layers))]
    looks = {curve.name: _INPUT for curve in energy_input}
    return curves_plot(title, "budget", shown, time_range, x=axis_of("time", units), looks=looks)


def _spectra(sheet: panels.Sheet) -> Any:
    """Amplitude of the velocity over frequency; colour and dashes are the chain's, the mark is the bead's."""
    first, *others = sheet.panels
    frequency = first.curves[0].x
    ends = Range1d(float(frequency[0]), float(frequency[-1]), bounds="auto")
    first = replace(first, y=replace(first.y, label=replace(first.y.label, words="amplitude")))  # legends leave no room
    return curves_plot("spectra of the velocities", "spectra", [first, *others], ends)


def _dispersion(problem: Problem, sheet: panels.Sheet) -> Any:
    """Power over wavenumber and frequency, with the exact branches and the edges of their bands."""
    (panel,) = sheet.panels
    image, ends = panel.image, Range1d(*panel.x.ends, bounds=panel.x.ends)
    assert image is not None
    plot = graph(", ".join(filter(None, ["dispersion", panel.title])), "dispersion", panel.x, panel.y, ends)
    plot.y_range = Range1d(*panel.y.ends, bounds=panel.y.ends)
    plot.xaxis.ticker = FixedTicker(ticks=sorted(panel.x.ticks))
    plot.xaxis.major_label_overrides = dict(panel.x.ticks)
    plot.xaxis.formatter = CustomJSTickFormatter(code=TICK)
    low, high = image.colours
    colours = LinearColorMapper(palette=map_palette("magma"), low=low, high=high)
    (left, right), (bottom, top) = image.x, image.y
    box = {"x": [left], "y": [bottom], "dw": [right - left], "dh": [top - bottom]}
    source = ColumnDataSource({"power": [_coarser(image.values).astype(np.float32)], **box})
    drawn = plot.image("power", x="x", y="y", dw="dw", dh="dh", source=source, color_mapper=colours)
    tips = [("wavenumber", "$x"), ("frequency", "$y"), ("log10 of power / maximum", "@power")]
    plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips))
    title = "log10 (power / maximum)"
    plot.add_layout(ColorBar(color_mapper=colours, title=title, width=10), "right")
    plot.grid.visible = False
    add_tool_of_image(plot, problem.name, source, "power", [panel.x.label.plain, panel.y.label.plain, title])
    (curve,), (marks,) = panel.curves, panel.marks
    branches = plot.line(curve.x, curve.y, line_color="#00acc1", line_dash="dashed")
    style = {"line_color": "#9e9e9e", "line_dash": "dotted"}
    borders = [plot.line(panel.x.ends, [edge, edge], **style) for edge in marks.places]
    add_legend(plot, [(f"{curve.name} (dashed)", [branches]), (f"{marks.name} (dotted)", borders)])
    return plot


def _coarser(values: Floats) -> Floats:
    """Largest values of blocks of values [row, column], at most `_MOST_PIXELS` of them in each direction."""
    for axis in (0, 1):
        starts = np.unique(np.linspace(0, values.shape[axis], min(values.shape[axis], _MOST_PIXELS), endpoint=False))
        values = np.maximum.reduceat(values, starts.astype(int), axis=axis)
    return values
