"""Plots of a run's page: how they write numbers, beads and chains; maps in space and time; traces of clicked beads."""

from typing import Any

import matplotlib as mpl
import numpy as np
from bokeh.events import Tap
from bokeh.models import (
    AdaptiveTicker,
    ColorBar,
    ColumnDataSource,
    CrosshairTool,
    CustomJS,
    CustomJSHover,
    CustomJSTickFormatter,
    FixedTicker,
    HoverTool,
    LinearColorMapper,
    Span,
)
from bokeh.plotting import figure
from matplotlib.colors import to_hex

from analysis.figures.spacetime import COLOUR_SCALE, COLOURS, round_ticks, signed_root
from analysis.figures.style import CHAIN_COLOURS as ON_PAPER
from analysis.figures.style import Unit
from analysis.trajectory import Floats
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


# --- maps and traces --------------------------------------------------------------------------------------------------

BEAD_DASHES = ("solid", "6 3", "2 2", "8 2 2 2", "12 3", "5 2 2 2 2 2", "2 5", "12 3 3 3")
"""Of the traces of a bead, one for each bead that is shown."""

MOST_TRACES = len(BEAD_DASHES)
"""Or those of one bead, where there are more chains."""

PLOTS_A_ROW = 4

_BEAD = (
    "return String(beads[Math.max(0, Math.min(beads.length - 1, Math.round((special_vars.x - places[0]) / spacing)))])"
)

_WHEN = """
const k = time.length > 1 ? Math.round((special_vars.y - time[0]) / (time[1] - time[0])) : 0;
return time[Math.max(0, Math.min(time.length - 1, k))].toPrecision(6) + unit
"""

_TRACE = """
const distance = places.map(place => Math.abs(place - cb_obj.x)), i = distance.indexOf(Math.min(...distance));
const n = beads.length, some = chains.length, data = {...traces.data};
for (const key in data) data[key] = Array.from(data[key]);
if (data.label.includes(`bead ${beads[i]}, chain ${chains[0]}`)) return;
while (data.label.length > Math.max(0, most - some)) for (const key in data) data[key].splice(0, some);
let look = 0;
while (data.look.includes(look)) look++;
for (let c = 0; c < some; c++) {
  const vel = images[c].data.velocity[0], ys = [];
  for (let k = 0; k < time.length; k++) ys.push(vel[k * n + i]);
  data.xs.push(Array.from(time)); data.ys.push(ys); data.look.push(look);
  data.colour.push(colours[some > 1 ? c : look]); data.dash.push(dashes[some > 1 ? look : 0]);
  data.label.push(`bead ${beads[i]}, chain ${chains[c]}`);
}
traces.data = data;
"""


def image_source(part: Thinned, place: int) -> ColumnDataSource:
    """What a chain's map shows, and where it stands."""
    first, last = float(part.places[0]), float(part.places[-1])
    step = float(part.time[1] - part.time[0]) if len(part.time) > 1 else 1.0
    arrays = {name: [getattr(part, name)[place].astype(np.float32)] for name in ("velocity", "overlap", "force")}
    half = 0.5 * part.spacing
    box = {
        "x": [first - half],
        "y": [float(part.time[0]) - 0.5 * step],
        "dw": [last - first + 2.0 * half],
        "dh": [float(part.time[-1] - part.time[0]) + step],
    }
    return ColumnDataSource(name=f"chain-{part.chains[place]}", data={**arrays, **box})


def maps_of(
    part: Thinned,
    images: list[ColumnDataSource],
    now: Span,
    colours: LinearColorMapper,
    units: Units,
    sight: tuple[float, float],
) -> tuple[list[Any], Any, Any]:
    """Velocity in space and time, a plot for each chain, with linked axes and a cursor that says the numbers.

    Args:
        sight: places that are seen at first.
    """
    across = min(PLOTS_A_ROW, len(part.chains))
    lists = {"beads": part.beads.tolist(), "places": part.places.tolist(), "spacing": part.spacing}
    when = {"time": part.time.tolist(), "unit": behind(units["time"])}
    kinds = {"velocity": ("velocity", "velocity")}
    if np.any(np.isfinite(part.overlap)):
        kinds |= {"overlap": ("overlap with the next", "length"), "force": ("force on the next", "force")}
    formatters = {"$x": CustomJSHover(args=lists, code=_BEAD), "$y": CustomJSHover(args=when, code=_WHEN)}
    formatters |= {f"@{name}": number(units[kind]) for name, (_, kind) in kinds.items()}
    tips = [("bead", "$x{custom}"), ("time", "$y{custom}")]
    tips += [(said, f"@{name}{{custom}}") for name, (said, _) in kinds.items()]
    found: list[Any] = []
    for source, chain in zip(images, part.chains, strict=True):
        shared = {"x_range": found[0].x_range, "y_range": found[0].y_range} if found else {"x_range": sight}
        plot = figure(
            title=f"chain {chain}",
            tools=TOOLS,
            active_scroll="wheel_zoom",
            height=430,
            sizing_mode="stretch_width",
            y_axis_label=axis_label("time", units["time"]),
            **shared,
        )
        drawn = plot.image("velocity", x="x", y="y", dw="dw", dh="dh", source=source, color_mapper=colours)
        plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips, formatters=formatters))
        plot.add_tools(CrosshairTool(line_alpha=0.4))
        plot.add_layout(now)
        plot.grid.visible = False
        label(plot)
        name_places(plot, part)
        plot.xaxis.ticker.desired_num_ticks = 8 // across + 2
        if len(found) == across - 1:
            plot.add_layout(_bar(colours, axis_label("velocity", units["velocity"])), "right")
        found.append(plot)
    return found, found[0].x_range, found[0].y_range


def root_colours(largest: float) -> LinearColorMapper:
    """Those of the figures: diverging from 0, along the signed square root of the velocity."""
    share = np.linspace(-1.0, 1.0, 1025)
    return LinearColorMapper(palette=_palette(signed_root(share)), low=-largest, high=largest, nan_color="#999999")


def _palette(share: Floats) -> list[str]:
    """Colours at shares of the scale, from -1 to 1."""
    return [to_hex(colour) for colour in mpl.colormaps[COLOURS](0.5 + 0.5 * share)]


def _bar(colours: LinearColorMapper, title: str) -> ColorBar:
    """The bar of those colours: even along the root, with round numbers of velocity."""
    end = float(np.sqrt(colours.high))
    even = LinearColorMapper(palette=_palette(np.linspace(-1.0, 1.0, 255)), low=-end, high=end)
    ticks = {float(signed_root(np.array(tick))): f"{tick:.4g}" for tick in round_ticks(colours.high)}
    return ColorBar(
        color_mapper=even,
        title=f"{title}; {COLOUR_SCALE}",
        width=10,
        ticker=FixedTicker(ticks=list(ticks)),
        major_label_overrides=ticks,
    )


def traces_of(part: Thinned, shown: list[int], time_range: Any, units: Units) -> tuple[Any, ColumnDataSource]:
    """Velocity of some beads over time; a click into a map adds one."""
    data: dict[str, list[Any]] = {"xs": [], "ys": [], "label": [], "colour": [], "dash": [], "look": []}
    many = len(part.chains) > 1
    for look, bead in enumerate(shown[: max(1, 6 // len(part.chains))]):
        k = int(np.argmin(np.abs(part.beads - bead)))
        for place, chain in enumerate(part.chains):
            data["xs"].append(part.time.astype(np.float32))
            data["ys"].append(part.velocity[place, :, k].astype(np.float32))
            data["colour"].append(CHAIN_COLOURS[place if many else look])
            data["dash"].append(BEAD_DASHES[look if many else 0])
            data["look"].append(look)
            data["label"].append(f"bead {part.beads[k]}, chain {chain}")
    source = ColumnDataSource(name="traces", data=data)
    span = float(part.time[0]), float(part.time[-1])
    plot = graph("velocity over time; click a map for more", units, "velocity", span)
    time_range.js_link("start", plot.x_range, "start")
    time_range.js_link("end", plot.x_range, "end")
    plot.multi_line(
        "xs", "ys", source=source, line_color="colour", line_dash="dash", legend_field="label", line_width=1.5
    )
    put_legend_aside(plot)
    return plot, source


def on_click(maps: list[Any], part: Thinned, images: list[ColumnDataSource], traces: ColumnDataSource) -> None:
    """Add the traces of the bead that is clicked in a map, in place of the oldest where there are too many."""
    tap = CustomJS(
        args={
            "beads": part.beads.tolist(),
            "places": part.places.tolist(),
            "chains": part.chains,
            "time": part.time.tolist(),
            "images": images,
            "traces": traces,
            "colours": list(CHAIN_COLOURS),
            "dashes": list(BEAD_DASHES),
            "most": MOST_TRACES,
        },
        code=_TRACE,
    )
    for one in maps:
        one.js_on_event(Tap, tap)
