"""What the plots of a run's page share: axes, numbers, looks of lines and legends; and maps in space and time."""

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from bokeh.models import (
    AdaptiveTicker,
    ColorBar,
    ColumnDataSource,
    CrosshairTool,
    CustomJSHover,
    CustomJSTickFormatter,
    FixedTicker,
    HoverTool,
    Legend,
    LegendItem,
    LinearColorMapper,
    LogTickFormatter,
    Range1d,
    Select,
    Span,
)
from bokeh.plotting import figure
from matplotlib.colors import to_hex

from granchain.parts import Floats, Problem, panels, spacetime, style, units
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.units import Units, axis_of

_SEEN_ON_DARK = {"#000000": "#44aa99", "#882255": "#aa4499"}
"""Teal and purple (Tol) for black and wine, which are hard to see in dark mode."""

CHAIN_COLOURS = tuple(_SEEN_ON_DARK.get(colour, colour) for colour in style.CHAIN_COLOURS)
"""Colours of the figures, of those that are seen in both themes."""

LINE_WIDTH = 1.5

CHAIN_DASHES = tuple(
    [round(LINE_WIDTH * length) for length in dash[1]] if isinstance(dash, tuple) else [] for dash in style.CHAIN_DASHES
)
"""Dashes of the figures, in pixels; an empty list is a solid line."""

MARKS = ("circle", "square", "triangle", "diamond", "inverted_triangle", "plus", "x", "asterisk")
"""Marks at the largest value of a line, one for each bead or gauge, where colour and dashes are the chain's."""

TOOLS = "pan,wheel_zoom,box_zoom,reset,save"

TICK = "return String(+tick.toPrecision(6))"
"""Numbers on axes, without the zeros that Bokeh would put behind those with a power of ten."""

_NUMBER = "return isNaN(value) ? '\N{EN DASH}' : String(+value.toPrecision(6)) + unit"

_NAME = "return Number.isInteger(tick) && tick in beads ? String(beads[tick]) : ''"
"""Of a bead that stands side by side with those that are not its neighbours."""


NOW = "now"
"""Name of the lines that mark the time in plots."""

_NOW = ({"line_color": "#000000", "line_width": 4.5}, {"line_color": "#ffe100", "line_width": 2})
"""Looks of these lines over maps: yellow on a black rim is seen on all their colours."""


def graph(title: str, name: str, x: panels.Axis, y: panels.Axis, x_range: Range1d) -> Any:
    """A plot of lines, of a quantity over another one or over beads.

    Args:
        title: above it.
        name: of the file that is saved.
        x, y: its axes.
        x_range: shared by plots over the same quantity.
    """
    plot = figure(
        title=title,
        name=name,
        tools=TOOLS,
        toolbar_location="above",
        toolbar_sticky=False,
        height=360,
        sizing_mode="stretch_width",
        x_axis_label=x.label.plain,
        y_axis_label=y.label.plain,
        y_axis_type="log" if y.log else "auto",
        x_range=x_range,
    )
    plot.toolbar.logo = None
    label(plot)
    if x.label.words == "time":
        line = Span(name=NOW, dimension="height", location=x_range.start, line_color="#888888", line_width=1.5)
        plot.add_layout(line)
    if x.beads:
        plot.xaxis.ticker = whole_numbers()
    if y.log:
        plot.yaxis.formatter = LogTickFormatter()
        plot.y_range = Range1d(*y.ends)
    return plot


def whole_numbers() -> AdaptiveTicker:
    """Ticks at whole numbers only."""
    return AdaptiveTicker(mantissas=[1, 2, 5], min_interval=1, num_minor_ticks=0)


def look(place: int) -> dict[str, Any]:
    """How the line of a chain is drawn, or of a bead or gauge where there is one chain."""
    colour, dash = CHAIN_COLOURS[place % len(CHAIN_COLOURS)], CHAIN_DASHES[place % len(CHAIN_DASHES)]
    return {"line_color": colour, "line_dash": dash, "line_width": LINE_WIDTH}


def mark(plot: Any, source: ColumnDataSource, chain: int, number: int) -> Any:
    """The mark of the bead or gauge of a number, in the colour of a chain (by its place), at the points of a source."""
    colour = CHAIN_COLOURS[chain % len(CHAIN_COLOURS)]
    kind = MARKS[number % len(MARKS)]
    return plot.scatter("x", "y", source=source, marker=kind, size=8, line_color=colour, fill_color=colour)


def largest(x: Floats, y: Floats) -> dict[str, list[float]]:
    """Point of a line x, y [point] where its value is largest in size, as data of a source; none where all are NaN."""
    if not np.any(np.isfinite(y)):
        return {"x": [], "y": []}
    place = int(np.nanargmax(np.abs(y)))
    return {"x": [float(x[place])], "y": [float(y[place])]}


def add_legend(plot: Any, items: Sequence[tuple[str, list[Any]]]) -> Legend:
    """A legend below a plot, where it hides no curve; a click on a name hides what is drawn for it, or shows it again.

    Args:
        plot: to add it to.
        items: names, empty for what is not shown yet, and what is drawn for each.
    """
    legend = Legend(
        items=[LegendItem(label=name, renderers=drawn, visible=bool(name)) for name, drawn in items],
        click_policy="hide",
        orientation="horizontal",
        ncols=3,
        location="left",
        label_text_font_size="8pt",
        glyph_width=36,  # dashes are told apart
        margin=0,
        spacing=8,
        padding=3,
        border_line_color=None,
        background_fill_alpha=0.0,
    )
    plot.add_layout(legend, "below")
    return legend


def chain_name(chain: int) -> str:
    """Name of what is drawn for a chain."""
    return f"chain {chain}"


DARK_CONTROL = """
@media (prefers-color-scheme: dark) {
  .bk-input, .bk-btn.bk-btn-default { background-color: #26292f; color: #ddd; border-color: #777; }
  .bk-btn.bk-btn-default.bk-active { background-color: #4a4f59; }
}
"""
"""Buttons and choices in dark mode."""


def choice(title: str, value: str, options: Sequence[str | tuple[str, str]], name: str) -> Select:
    """A choice among some words, or among values with words for each."""
    return Select(title=title, value=value, options=list(options), name=name, stylesheets=[DARK_CONTROL])


def label(plot: Any) -> None:
    """Write the numbers on axes as short as they are."""
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.formatter = CustomJSTickFormatter(code=TICK)


def lists(part: Thinned) -> dict[str, list[Any]]:
    """Beads, their places, chains and times, for scripts."""
    beads, places, time = part.beads.tolist(), part.places.tolist(), part.time.tolist()
    return {"beads": beads, "places": places, "chains": part.chains, "time": time}


def name_places(plot: Any, part: Thinned) -> None:
    """Write beads along the first axis; under those that stand side by side, their names."""
    plot.xaxis.axis_label = "bead" if part.even else "recorded bead"
    plot.xaxis.ticker = whole_numbers()
    if not part.even:
        plot.xaxis.formatter = CustomJSTickFormatter(args={"beads": part.beads.tolist()}, code=_NAME)


def number(unit: panels.AxisUnit) -> CustomJSHover:
    """How a cursor says a number."""
    return CustomJSHover(args={"unit": re.sub(r"[${}]", "", unit.behind)}, code=_NUMBER)


# --- maps -------------------------------------------------------------------------------------------------------------

_HIGH, _LOW = 430, 300
"""Pixels of a map, where they stand in one row and in several."""

_BEAD = (
    "return String(beads[Math.max(0, Math.min(beads.length - 1, Math.round((special_vars.x - places[0]) / spacing)))])"
)

_WHEN = """
const k = time.length > 1 ? Math.round((special_vars.y - time[0]) / (time[1] - time[0])) : 0;
return time[Math.max(0, Math.min(time.length - 1, k))].toPrecision(6) + unit
"""


class MapQuantity(NamedTuple):
    """A quantity of the maps: words, and those of a cursor; symbol in TeX, and key of its unit."""

    words: str
    of_cursor: str
    symbol: str
    unit: str


MAPPED = {
    "velocity": MapQuantity("velocity", "velocity", "v", "velocity"),
    "displacement": MapQuantity("displacement", "displacement", "x", "length"),
    "overlap": MapQuantity("overlap", "overlap with the next", "\\delta", "length"),
    "force": MapQuantity("contact force", "force on the next", "F", "force"),
    "density": MapQuantity("energy of each bead", "energy of the bead", "U", "energy"),
}
"""Quantities of a map, as the arrays of a `Thinned` are called."""


def label_of(name: str, page_units: Units) -> str:
    """Words, symbol and unit of a quantity of the maps, such as ``contact force F (N)``."""
    shown = MAPPED[name]
    return units.Label(shown.words, shown.symbol, page_units[shown.unit].symbol).plain


def shown_quantities(part: Thinned) -> list[str]:
    """Quantities of a map that are known anywhere."""
    return [name for name in MAPPED if np.any(np.isfinite(getattr(part, name)))]


def image_source(part: Thinned, place: int) -> ColumnDataSource:
    """What a chain's map shows, and where it stands."""
    arrays = {name: [getattr(part, name)[place].astype(np.float32)] for name in MAPPED}
    (left, right), (start, end) = ends(part.places, part.spacing), ends(part.time, part.every)
    box = {"x": [left], "y": [start], "dw": [right - left], "dh": [end - start]}
    return ColumnDataSource(name=f"chain-{part.chains[place]}", data={**arrays, **box})


def ends(values: Floats, spacing: float) -> tuple[float, float]:
    """Ends of an axis on which evenly spaced values [pixel] stand in the middle of their pixels, in their unit."""
    return float(values[0]) - 0.5 * spacing, float(values[-1]) + 0.5 * spacing


def maps_of(
    problem: Problem,
    part: Thinned,
    images: list[ColumnDataSource],
    colours: LinearColorMapper,
    units: Units,
    ranges: tuple[Range1d, Range1d],
) -> list[list[Any]]:
    """Velocity in space and time, a plot for each chain, in rows; a cursor says the numbers.

    Args:
        problem: what was run; the chains of a lattice stand as they do in it.
        part: of its frames, in units of the page.
        images: maps of the chains.
        colours: of velocities.
        units: of the page.
        ranges: of beads and of time, shared by all maps.
    """
    rows, across = spacetime.panels(problem, len(part.chains))
    now = [Span(name=NOW, dimension="width", location=part.time[0], **look_of_line) for look_of_line in _NOW]
    hover = _hover(part, units)
    maps: list[list[Any]] = [[] for _ in range(rows)]
    for place, (source, chain) in enumerate(zip(images, part.chains, strict=True)):
        plot = figure(
            title=chain_name(chain),
            tools=TOOLS,
            height=_HIGH if rows == 1 else _LOW,
            sizing_mode="stretch_width",
            x_range=ranges[0],
            y_range=ranges[1],
            y_axis_label=axis_of("time", units).label.plain,
        )
        drawn = plot.image("velocity", x="x", y="y", dw="dw", dh="dh", source=source, color_mapper=colours)
        plot.add_tools(HoverTool(renderers=[drawn], **hover), CrosshairTool(line_alpha=0.4))
        for line in now:
            plot.add_layout(line)
        plot.grid.visible = False
        plot.yaxis.visible = place % across == 0
        label(plot)
        name_places(plot, part)
        plot.xaxis.ticker.desired_num_ticks = 8 // across + 2
        if place == across - 1 or place == len(images) - 1 < across:
            plot.add_layout(_bar(colours, axis_of("velocity", units).label.plain), "right")
        maps[place // across].append(plot)
    return maps


def _hover(part: Thinned, units: Units) -> dict[str, Any]:
    """What a cursor over a map says: bead, time, and the quantities of the map that are known."""
    lists = {"beads": part.beads.tolist(), "places": part.places.tolist(), "spacing": part.spacing}
    when = {"time": part.time.tolist(), "unit": units["time"].behind}
    formatters = {"$x": CustomJSHover(args=lists, code=_BEAD), "$y": CustomJSHover(args=when, code=_WHEN)}
    shown = shown_quantities(part)
    formatters |= {f"@{name}": number(units[MAPPED[name].unit]) for name in shown}
    tips = [("bead", "$x{custom}"), ("time", "$y{custom}")]
    tips += [(MAPPED[name].of_cursor, f"@{name}{{custom}}") for name in shown]
    return {"tooltips": tips, "formatters": formatters}


def root_colours(limit: float) -> LinearColorMapper:
    """Those of the figures: diverging from 0, along the signed square root of the velocity."""
    share = np.linspace(-1.0, 1.0, 1025)
    return LinearColorMapper(
        palette=_palette(spacetime.RootScale.root(share)), low=-limit, high=limit, nan_color="#999999"
    )


def _palette(share: Floats, name: str = spacetime.RootScale.PALETTE) -> list[str]:
    """Colours of a palette of matplotlib at shares of its scale, from -1 to 1."""
    return [to_hex(colour) for colour in mpl.colormaps[name](0.5 + 0.5 * share)]


def map_palette(name: str = spacetime.RootScale.PALETTE) -> list[str]:
    """Colours of a palette of matplotlib from its one end to the other, by default that of velocities."""
    return _palette(np.linspace(-1.0, 1.0, 257), name)


def _bar(colours: LinearColorMapper, title: str) -> ColorBar:
    """The bar of those colours: even along the root, with round numbers of velocity."""
    end = float(np.sqrt(colours.high))
    even = LinearColorMapper(palette=_palette(np.linspace(-1.0, 1.0, 255)), low=-end, high=end)
    ticks = {
        float(spacetime.RootScale.root(np.array(tick))): f"{tick:.4g}"
        for tick in spacetime.RootScale(colours.high).ticks
    }
    return ColorBar(
        color_mapper=even,
        title=title,
        width=10,
        ticker=FixedTicker(ticks=list(ticks)),
        major_label_overrides=ticks,
    )
