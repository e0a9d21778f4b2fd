"""The plots of one run: velocity in space and time, moving beads, traces, peaks and energy."""

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.layouts import column, gridplot, row
from bokeh.models import (
    AdaptiveTicker,
    ColorBar,
    ColumnDataSource,
    CrosshairTool,
    CustomJS,
    CustomJSHover,
    CustomJSTickFormatter,
    HoverTool,
    LinearColorMapper,
    Slider,
    Span,
    Toggle,
)
from bokeh.palettes import diverging_palette, interp_palette
from bokeh.plotting import figure

from analysis.figures.spacetime import STILL, largest_afar, moving_part
from analysis.figures.style import CHAIN_COLOURS as ON_PAPER
from analysis.figures.style import Unit
from analysis.sharing.survey import Survey
from lammps_inputs import Problem
from lammps_inputs.facts import Fact
from workflow.view.thin import Thinned
from workflow.view.units import axis_label, behind, units_of

Units = dict[str, Unit]

BEADS_IN_SIGHT = 40
"""Around the front, where beads move."""

_EXAGGERATED = 0.25
"""Distances between neighbouring beads of a page for a displacement of L: what LAMMPS's, 4 wide, have."""

_BLUE_RED = diverging_palette(
    interp_palette(["#08306b", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7"], 128),
    interp_palette(["#67001f", "#b2182b", "#d6604d", "#f4a582", "#fddbc7", "#f7f7f7"], 128),
    n=255,
)

CHAIN_COLOURS = tuple("#44aa99" if colour == "#000000" else colour for colour in ON_PAPER)
"""Teal (Tol) for black, which is not seen in dark mode."""

BEAD_DASHES = ("solid", "6 3", "2 2", "8 2 2 2", "12 3", "5 2 2 2 2 2", "2 5", "12 3 3 3")
"""Of the traces of a bead, one for each bead that is shown."""

MOST_TRACES = len(BEAD_DASHES)
"""Or those of one bead, where there are more chains."""

PLOTS_A_ROW = 4

_BAR = 70
"""Width of the bar of colours."""

_TOOLS = "pan,wheel_zoom,box_zoom,reset,save"

_MOVE = """
const k = slider.value, n = places.length, T = time[k];
now.location = T;
const x = [], y = [], v = [], d = [], bead = [], chain = [], fx = [], fy = [], fh = [];
const sx0 = [], sx1 = [], sy0 = [], sy1 = [], sc = [];
let front = 0, fastest = 0;
for (let c = 0; c < images.length; c++) {
  const vel = images[c].data.velocity[0], force = images[c].data.force[0], dis = moved.data.displacement[c];
  for (let i = 0; i < n; i++) {
    const at = k * n + i;
    x.push(places[i] + exaggerated * dis[at]); y.push(-c); v.push(vel[at]);
    d.push(dis[at] * length); bead.push(beads[i]); chain.push(chains[c]);
    if (force[at] > 0) { fx.push(places[i] + 0.5 * spacing); fy.push(-c + 0.3); fh.push(0.45 * force[at] / strongest); }
    if (Math.abs(vel[at]) > fastest) { fastest = Math.abs(vel[at]); front = i; }
  }
}
for (const [a, b] of springs)
  for (let i = 0; i < n; i++) {
    const one = k * n + i, dis = moved.data.displacement, p = exaggerated * dis[a][one], q = exaggerated * dis[b][one];
    sx0.push(places[i] + p); sx1.push(places[i] + q);
    sy0.push(-a); sy1.push(-b); sc.push(Math.min(1, 0.15 + Math.abs(p - q) / spacing));
  }
balls.data = {x, y, v, d, bead, chain};
pushes.data = {x: fx, y: fy.map((low, i) => low + fh[i] / 2), h: fh};
ties.data = {x0: sx0, x1: sx1, y0: sy0, y1: sy1, alpha: sc};
const half = 0.5 * sight, first = places[0] - spacing, last = places[n - 1] + spacing;
const middle = Math.max(first + half, Math.min(last - half, places[front]));
if (last - first > sight) { range.start = middle - half; range.end = middle + half; }
"""

_TIME = "return time[Math.max(0, Math.min(time.length - 1, Math.round(tick)))].toPrecision(5) + unit"

_TICK = "return String(+tick.toPrecision(6))"
"""Numbers on axes, without the zeros that Bokeh would put behind those with a power of ten."""

_NUMBER = "return isNaN(value) ? '\N{EN DASH}' : String(+value.toPrecision(6)) + unit"

_BEAD = (
    "return String(beads[Math.max(0, Math.min(beads.length - 1, Math.round((special_vars.x - places[0]) / spacing)))])"
)

_WHEN = """
const k = time.length > 1 ? Math.round((special_vars.y - time[0]) / (time[1] - time[0])) : 0;
return time[Math.max(0, Math.min(time.length - 1, k))].toPrecision(6) + unit
"""

_NAME = "return Number.isInteger(tick) && tick in beads ? String(beads[tick]) : ''"
"""Of a bead that stands side by side with those that are not its neighbours."""

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

_PLAY = """
clearInterval(window.playing);
if (button.active) window.playing = setInterval(() => {
  slider.value = slider.value >= slider.end ? slider.start : slider.value + Math.max(1, Math.round(slider.end / 400));
}, 40);
"""


def layout(problem: Problem, part: Thinned, found: Survey | None, shown: list[int]) -> Any:
    """The plots of a page.

    Args:
        problem: what was run.
        part: of its frames, dimensionless.
        found: the waves in it; None where there are none.
        shown: beads whose velocity over time is drawn first.
    """
    units = units_of(problem, part)
    part = part.measured(units)
    images = [_image_source(part, place) for place in range(len(part.chains))]
    now = Span(dimension="width", location=float(part.time[0]), line_color="#d55e00", line_width=1.5)
    largest = largest_afar(problem, part.beads, part.velocity)
    colours = LinearColorMapper(palette=_BLUE_RED, low=-largest, high=largest, nan_color="#999999")
    moved = np.nanmax(np.abs(part.velocity), axis=(0, 1), initial=0.0) > STILL * largest
    half = 0.5 * part.spacing
    whole = (float(part.places[0]) - half, float(part.places[-1]) + half)
    maps, place_range, time_range = _maps(part, images, now, colours, units, moving_part(part.places, moved, whole))
    there = part.beads[moved] if moved.any() else part.beads
    shown = [
        bead if bead in there else int(there[share * (len(there) - 1) // 6])
        for bead, share in zip(shown, (1, 3, 5), strict=False)
    ]
    traces, trace_source = _traces(part, list(dict.fromkeys(shown)), time_range, units)
    moving, controls = _moving(problem, part, images, now, colours, units)
    tap = CustomJS(
        args={
            "beads": part.beads.tolist(),
            "places": part.places.tolist(),
            "chains": part.chains,
            "time": part.time.tolist(),
            "images": images,
            "traces": trace_source,
            "colours": list(CHAIN_COLOURS),
            "dashes": list(BEAD_DASHES),
            "most": MOST_TRACES,
        },
        code=_TRACE,
    )
    for one in maps:
        one.js_on_event(Tap, tap)
    below = [traces]
    if found is not None and problem.holds(Fact.PULSE):
        bead_range = place_range if part.even else (float(part.beads[0]) - 1.0, float(part.beads[-1]) + 1.0)
        below += _distances(problem, part, found, bead_range, units)
    if problem.whole:
        below.append(_energy(part, traces.x_range, units))
    moving.toolbar.logo = None
    across = min(PLOTS_A_ROW, len(maps))
    side_by_side = gridplot(
        [maps[k : k + across] for k in range(0, len(maps), across)],
        toolbar_location="right",
        toolbar_options={"logo": None},
        sizing_mode="stretch_width",
    )
    # beside the last of a row are the colours; a page that is narrow makes all maps narrower
    side_by_side.cols = [f"calc((100% - {_BAR}px) / {across})"] * (across - 1) + ["1fr"]
    return column(
        side_by_side,
        controls,
        moving,
        gridplot(
            [below[k : k + 2] for k in range(0, len(below), 2)],
            merge_tools=False,
            toolbar_options={"logo": None},
            sizing_mode="stretch_width",
        ),
        sizing_mode="stretch_width",
    )


def _image_source(part: Thinned, place: int) -> ColumnDataSource:
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


def _maps(
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
    told = {"$x": CustomJSHover(args=lists, code=_BEAD), "$y": CustomJSHover(args=when, code=_WHEN)}
    told |= {f"@{name}": _number(units[kind]) for name, (_, kind) in kinds.items()}
    tips = [("bead", "$x{custom}"), ("time", "$y{custom}")]
    tips += [(said, f"@{name}{{custom}}") for name, (said, _) in kinds.items()]
    found: list[Any] = []
    for source, chain in zip(images, part.chains, strict=True):
        shared = {"x_range": found[0].x_range, "y_range": found[0].y_range} if found else {"x_range": sight}
        plot = figure(
            title=f"chain {chain}",
            tools=_TOOLS,
            active_scroll="wheel_zoom",
            height=430,
            sizing_mode="stretch_width",
            y_axis_label=axis_label("time", units["time"]),
            **shared,
        )
        drawn = plot.image("velocity", x="x", y="y", dw="dw", dh="dh", source=source, color_mapper=colours)
        plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips, formatters=told))
        plot.add_tools(CrosshairTool(line_alpha=0.4))
        plot.add_layout(now)
        plot.grid.visible = False
        _label(plot)
        _name_places(plot, part)
        plot.xaxis.ticker.desired_num_ticks = 8 // across + 2
        if len(found) == across - 1:
            bar = ColorBar(color_mapper=colours, title=axis_label("velocity", units["velocity"]), width=10)
            plot.add_layout(bar, "right")
        found.append(plot)
    return found, found[0].x_range, found[0].y_range


def _traces(part: Thinned, shown: list[int], time_range: Any, units: Units) -> tuple[Any, ColumnDataSource]:
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
    plot = _graph(
        "velocity over time; click a map for more",
        axis_label("time", units["time"]),
        axis_label("velocity", units["velocity"]),
        (float(part.time[0]), float(part.time[-1])),
    )
    time_range.js_link("start", plot.x_range, "start")
    time_range.js_link("end", plot.x_range, "end")
    plot.multi_line(
        "xs", "ys", source=source, line_color="colour", line_dash="dash", legend_field="label", line_width=1.5
    )
    _put_legend_aside(plot)
    return plot, source


def _moving(
    problem: Problem,
    part: Thinned,
    images: list[ColumnDataSource],
    now: Span,
    colours: LinearColorMapper,
    units: Units,
) -> tuple[Any, Any]:
    """Beads, springs and contact forces at one time, with a slider and a button that moves it."""
    chains = len(part.chains)
    first, last = float(part.places[0]) - part.spacing, float(part.places[-1]) + part.spacing
    sight = BEADS_IN_SIGHT * part.spacing
    plot = figure(
        tools="xpan,xwheel_zoom,reset,save",
        height=110 + 46 * chains,
        sizing_mode="stretch_width",
        x_range=(first, min(last, first + sight)),
        y_range=(-chains + 0.4, 0.9),
    )
    _label(plot)
    _name_places(plot, part)
    spacings = "spacings" if part.bead_stride == 1 and part.even else "times the spacing shown"
    bars = ", bars: contact force" if np.any(np.isfinite(part.force)) else ""
    plot.xaxis.axis_label += f"; displacements times {_EXAGGERATED:g} {spacings} / L{bars}"
    plot.yaxis.ticker = [-k for k in range(chains)]
    plot.yaxis.major_label_overrides = {-k: f"chain {chain}" for k, chain in enumerate(part.chains)}
    plot.grid.visible = False
    balls = ColumnDataSource(name="balls", data={name: [] for name in ("x", "y", "v", "d", "bead", "chain")})
    pushes = ColumnDataSource(name="pushes", data={"x": [], "y": [], "h": []})
    ties = ColumnDataSource(name="ties", data={"x0": [], "x1": [], "y0": [], "y1": [], "alpha": []})
    plot.segment("x0", "y0", "x1", "y1", source=ties, line_color="#7a5195", line_alpha="alpha", line_width=2)
    plot.rect("x", "y", width=0.35 * part.spacing, height="h", source=pushes, fill_color="#e69f00", line_color=None)
    drawn = plot.scatter(
        "x", "y", size=13, source=balls, fill_color={"field": "v", "transform": colours}, line_color="#555555"
    )
    plot.add_tools(
        HoverTool(
            renderers=[drawn],
            tooltips=[
                ("bead", "@bead"),
                ("chain", "@chain"),
                ("displacement", "@d{custom}"),
                ("velocity", "@v{custom}"),
            ],
            formatters={"@d": _number(units["length"]), "@v": _number(units["velocity"])},
        )
    )
    length = units["length"].worth
    moved = ColumnDataSource(
        name="moved", data={"displacement": [(x / length).astype(np.float32) for x in part.displacement]}
    )
    told = CustomJSTickFormatter(args={"time": part.time.tolist(), "unit": behind(units["time"])}, code=_TIME)
    slider = Slider(start=0, end=max(1, len(part.time) - 1), value=0, step=1, title="time", name="time", format=told)
    slider.sizing_mode = "stretch_width"
    button = Toggle(label="play", width=70, name="play")  # a button whose label changes would lose the focus
    rows = {chain - 1: k for k, chain in enumerate(part.chains)}
    edges = [edge for link in problem.across for edge in link.edges if edge[0] in rows and edge[1] in rows]
    move = CustomJS(
        args={
            "slider": slider,
            "now": now,
            "beads": part.beads.tolist(),
            "places": part.places.tolist(),
            "chains": part.chains,
            "time": part.time.tolist(),
            "images": images,
            "moved": moved,
            "balls": balls,
            "pushes": pushes,
            "ties": ties,
            "range": plot.x_range,
            "springs": [[rows[one], rows[other]] for one, other in edges],
            "strongest": float(np.nanmax(part.force, initial=0.0)) or 1.0,
            "exaggerated": _EXAGGERATED * part.spacing,
            "length": length,
            "spacing": part.spacing,
            "sight": sight,
        },
        code=_MOVE,
    )
    slider.js_on_change("value", move)
    button.js_on_change("active", CustomJS(args={"slider": slider, "button": button}, code=_PLAY))
    plot.js_on_change("inner_width", move)  # once, when the page is laid out
    return plot, row(button, slider, sizing_mode="stretch_width")


def _distances(problem: Problem, part: Thinned, found: Survey, bead_range: Any, units: Units) -> list[Any]:
    """Peak velocity, lag and energy of the leading pulse along the chains."""
    waves, time, velocity = found.waves, units["time"], units["velocity"]
    if not len(waves):
        return []
    peaks = _graph("peak velocity of the leading pulse", "bead", axis_label("velocity", velocity), bead_range)
    hit = problem.hardest_blow[0]
    lags = _graph(f"arrival after that in chain {hit}", "bead", axis_label("time", time), bead_range)
    reference = waves.of_chain(hit)
    drawn = []
    for place, chain in enumerate(part.chains):
        own = waves.of_chain(chain)
        if not len(own):
            continue
        style = _of_chain(place, chain)
        peak = {"bead": own.bead, "peak": own.peak_velocity * velocity.worth}
        drawn.append(peaks.line("bead", "peak", source=peak, **style))
        both, mine, theirs = np.intersect1d(own.bead, reference.bead, return_indices=True)
        lags.line(both, (own.arrival[mine] - reference.arrival[theirs]) * time.worth, **style)
    tips = [("bead", "@bead"), ("peak velocity", "@peak{custom}")]
    peaks.add_tools(HoverTool(renderers=drawn, tooltips=tips, formatters={"@peak": _number(velocity)}))
    graphs = [peaks, lags] if len(drawn) > 1 else [peaks]
    for plot in graphs:
        _put_legend_aside(plot)
    return graphs


def _energy(part: Thinned, time_range: Any, units: Units) -> Any:
    """Energy of the beads of each chain that is shown, with their contacts and what holds them, over time."""
    heading = "energy of each chain, without coupling"
    plot = _graph(heading, axis_label("time", units["time"]), axis_label("energy", units["energy"]), time_range)
    for place, chain in enumerate(part.chains):
        plot.line(part.time, part.energy[place], **_of_chain(place, chain))
    _put_legend_aside(plot)
    return plot


def _graph(title: str, x: str, y: str, x_range: Any) -> Any:
    """A plot of lines."""
    plot = figure(
        title=title,
        tools=_TOOLS,
        height=330,
        sizing_mode="stretch_width",
        x_axis_label=x,
        y_axis_label=y,
        x_range=x_range,
    )
    plot.toolbar.logo = None
    _label(plot)
    return plot


def _put_legend_aside(plot: Any) -> None:
    """Where it hides no curve."""
    legend = plot.legend[0]
    legend.label_text_font_size = "8pt"
    legend.padding = 3
    legend.border_line_color = None
    legend.background_fill_alpha = 0.0
    plot.add_layout(legend, "right")


def _label(plot: Any) -> None:
    """Write the numbers on axes as short as they are."""
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.formatter = CustomJSTickFormatter(code=_TICK)


def _name_places(plot: Any, part: Thinned) -> None:
    """Write beads along the first axis; under those that stand side by side, their names."""
    plot.xaxis.axis_label = "bead" if part.even else "recorded bead"
    if not part.even:
        plot.xaxis.ticker = AdaptiveTicker(mantissas=[1, 2, 5], min_interval=1, num_minor_ticks=0)
        plot.xaxis.formatter = CustomJSTickFormatter(args={"beads": part.beads.tolist()}, code=_NAME)


def _number(unit: Unit) -> CustomJSHover:
    """How a cursor says a number."""
    return CustomJSHover(args={"unit": behind(unit)}, code=_NUMBER)


def _of_chain(place: int, chain: int) -> dict[str, Any]:
    """How the line of a chain is drawn."""
    return {"line_color": CHAIN_COLOURS[place], "legend_label": f"chain {chain}", "line_width": 1.5}
