"""What the plots of a run's page share: how numbers, beads and chains are written, and where legends stand."""

from typing import Any

from bokeh.models import AdaptiveTicker, CustomJSHover, CustomJSTickFormatter
from bokeh.plotting import figure

from analysis.figures.style import CHAIN_COLOURS as ON_PAPER
from analysis.figures.style import Unit
from workflow.view.thin import Thinned, Units, axis_label, behind

CHAIN_COLOURS = tuple("#44aa99" if colour == "#000000" else colour for colour in ON_PAPER)
"""Teal (Tol) for black, which is not seen in dark mode."""

TOOLS = "pan,wheel_zoom,box_zoom,reset,save"

TICK = "return String(+tick.toPrecision(6))"
"""Numbers on axes, without the zeros that Bokeh would put behind those with a power of ten."""

_NUMBER = "return isNaN(value) ? '\N{EN DASH}' : String(+value.toPrecision(6)) + unit"

_NAME = "return Number.isInteger(tick) && tick in beads ? String(beads[tick]) : ''"
"""Of a bead that stands side by side with those that are not its neighbours."""


def graph(title: str, units: Units, y: str, x_range: Any, x: str = "time") -> Any:
    """A plot of lines, of a quantity over another one or over beads."""
    plot = figure(
        title=title,
        tools=TOOLS,
        height=330,
        sizing_mode="stretch_width",
        x_axis_label=axis_label(x, units[x]) if x in units else x,
        y_axis_label=axis_label(y, units[y]),
        x_range=x_range,
    )
    plot.toolbar.logo = None
    label(plot)
    return plot


def put_legend_aside(plot: Any) -> None:
    """Where it hides no curve."""
    legend = plot.legend[0]
    legend.label_text_font_size = "8pt"
    legend.padding = 3
    legend.border_line_color = None
    legend.background_fill_alpha = 0.0
    plot.add_layout(legend, "right")


def label(plot: Any) -> None:
    """Write the numbers on axes as short as they are."""
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.formatter = CustomJSTickFormatter(code=TICK)


def name_places(plot: Any, part: Thinned) -> None:
    """Write beads along the first axis; under those that stand side by side, their names."""
    plot.xaxis.axis_label = "bead" if part.even else "recorded bead"
    if not part.even:
        plot.xaxis.ticker = AdaptiveTicker(mantissas=[1, 2, 5], min_interval=1, num_minor_ticks=0)
        plot.xaxis.formatter = CustomJSTickFormatter(args={"beads": part.beads.tolist()}, code=_NAME)


def number(unit: Unit) -> CustomJSHover:
    """How a cursor says a number."""
    return CustomJSHover(args={"unit": behind(unit)}, code=_NUMBER)


def of_chain(place: int, chain: int) -> dict[str, Any]:
    """How the line of a chain is drawn."""
    return {"line_color": CHAIN_COLOURS[place], "legend_label": f"chain {chain}", "line_width": 1.5}
