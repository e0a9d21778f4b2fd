"""The plots of one run: velocity in space and time, moving beads, traces, peaks and energy."""

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.layouts import column, gridplot, row
from bokeh.models import (
    Button,
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
)
from bokeh.palettes import diverging_palette, interp_palette
from bokeh.plotting import figure

from analysis.figures.spacetime import STILL, largest_afar, moving_part
from analysis.figures.style import CHAIN_COLOURS as ON_PAPER
from analysis.sharing.survey import Survey
from lammps_inputs import Problem
from workflow.view.thin import Thinned

BEADS_IN_SIGHT = 40
"""Around the front, where beads move."""

_EXAGGERATED = 0.25
"""Distances between neighbours for a displacement of L: what LAMMPS's beads of a diameter of 4 have."""

_BLUE_RED = diverging_palette(
    interp_palette(["#08306b", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7"], 128),
    interp_palette(["#67001f", "#b2182b", "#d6604d", "#f4a582", "#fddbc7", "#f7f7f7"], 128),
    n=255,
)

CHAIN_COLOURS = tuple("#44aa99" if colour == "#000000" else colour for colour in ON_PAPER)
"""Teal (Tol) for black, which is not seen in dark mode."""

PLOTS_A_ROW = 4

_PAGE = 1240
"""Width of all plots beside each other."""

_BAR = 70
"""Width of the bar of colours."""

_TOOLS = "pan,wheel_zoom,box_zoom,reset,save"

_MOVE = """
const k = slider.value, n = beads.length, T = time[k];
now.location = T;
const x = [], y = [], v = [], fx = [], fy = [], fh = [], sx0 = [], sx1 = [], sy0 = [], sy1 = [], sc = [];
let front = 0, fastest = 0;
for (let c = 0; c < images.length; c++) {
  const vel = images[c].data.velocity[0], force = images[c].data.force[0], dis = moved.data.displacement[c];
  for (let i = 0; i < n; i++) {
    const at = k * n + i;
    x.push(beads[i] + exaggerated * dis[at]); y.push(-c); v.push(vel[at]);
    if (force[at] > 0) { fx.push(beads[i] + 0.5 * stride); fy.push(-c + 0.3); fh.push(0.45 * force[at] / strongest); }
    if (Math.abs(vel[at]) > fastest) { fastest = Math.abs(vel[at]); front = i; }
  }
}
for (const [a, b] of springs)
  for (let i = 0; i < n; i++) {
    const one = k * n + i, p = moved.data.displacement[a][one], q = moved.data.displacement[b][one];
    sx0.push(beads[i] + exaggerated * p); sx1.push(beads[i] + exaggerated * q);
    sy0.push(-a); sy1.push(-b); sc.push(Math.min(1, 0.15 + Math.abs(p - q) * exaggerated));
  }
balls.data = {x, y, v};
pushes.data = {x: fx, y: fy.map((low, i) => low + fh[i] / 2), h: fh};
ties.data = {x0: sx0, x1: sx1, y0: sy0, y1: sy1, alpha: sc};
const half = 0.5 * sight, middle = Math.max(beads[0] + half - 1, Math.min(beads[n - 1] - half + 1, beads[front]));
if (beads[n - 1] - beads[0] > sight) { range.start = middle - half; range.end = middle + half; }
"""

_TIME = "return time[Math.max(0, Math.min(time.length - 1, Math.round(tick)))].toPrecision(5) + unit"

_TICK = "return String(+tick.toPrecision(6))"
"""Numbers on axes, without the zeros that Bokeh would put behind those with a power of ten."""

_TRACE = """
const distance = beads.map(bead => Math.abs(bead - cb_obj.x)), i = distance.indexOf(Math.min(...distance));
const n = beads.length, data = {...traces.data};
for (const key in data) data[key] = Array.from(data[key]);
if (data.label.includes(`bead ${beads[i]}, chain ${chains[0]}`)) return;
while (data.label.length + images.length > 8) for (const key in data) data[key].shift();
for (let c = 0; c < images.length; c++) {
  const vel = images[c].data.velocity[0], ys = [];
  for (let k = 0; k < time.length; k++) ys.push(vel[k * n + i]);
  data.xs.push(Array.from(time)); data.ys.push(ys);
  data.colour.push(colours[data.label.length % colours.length]);
  data.label.push(`bead ${beads[i]}, chain ${chains[c]}`);
}
traces.data = data;
"""

_PLAY = """
if (window.playing) { clearInterval(window.playing); window.playing = null; button.label = 'play'; return; }
button.label = 'stop';
window.playing = setInterval(() => {
  slider.value = slider.value >= slider.end ? slider.start : slider.value + Math.max(1, Math.round(slider.end / 400));
}, 40);
"""


def layout(problem: Problem, part: Thinned, found: Survey | None, shown: list[int]) -> Any:
    """The plots of a page.

    Args:
        problem: what was run.
        part: of its frames.
        found: the waves in it; None where there are none.
        shown: beads whose velocity over time is drawn first.
    """
    symbol = {name: f" ({problem.scale.symbol(name)})" if problem.scale.si else "" for name in ("time", "velocity")}
    images = [_image_source(part, place) for place in range(len(part.chains))]
    now = Span(dimension="width", location=float(part.time[0]), line_color="#d55e00", line_width=1.5)
    largest = largest_afar(problem, part.beads, part.velocity)
    colours = LinearColorMapper(palette=_BLUE_RED, low=-largest, high=largest, nan_color="#999999")
    moved = np.nanmax(np.abs(part.velocity), axis=(0, 1), initial=0.0) > STILL * largest
    half = 0.5 * part.bead_stride
    sight = moving_part(part.beads, moved, (float(part.beads[0]) - half, float(part.beads[-1]) + half))
    maps, bead_range, time_range = _maps(part, images, now, colours, symbol, sight)
    there = part.beads[moved] if moved.any() else part.beads
    shown = [
        bead if bead in there else int(there[share * (len(there) - 1) // 6])
        for bead, share in zip(shown, (1, 3, 5), strict=False)
    ]
    traces, trace_source = _traces(part, shown, time_range, symbol)
    moving, controls = _moving(problem, part, images, now, colours)
    tapped = {"beads": part.beads.tolist(), "chains": part.chains, "time": part.time.tolist(), "images": images}
    tap = CustomJS(args={**tapped, "traces": trace_source, "colours": list(CHAIN_COLOURS)}, code=_TRACE)
    for one in maps:
        one.js_on_event(Tap, tap)
    below = [traces]
    if found is not None:
        below += _distances(problem, part, found, bead_range, symbol)
    if problem.whole:
        below.append(_energy(problem, part, traces.x_range, symbol))
    moving.toolbar.logo = None
    return column(
        gridplot(
            [maps[k : k + PLOTS_A_ROW] for k in range(0, len(maps), PLOTS_A_ROW)],
            toolbar_location="right",
            toolbar_options={"logo": None},
        ),
        controls,
        moving,
        gridplot(
            [below[k : k + 2] for k in range(0, len(below), 2)], merge_tools=False, toolbar_options={"logo": None}
        ),
        sizing_mode="stretch_width",
    )


def _image_source(part: Thinned, place: int) -> ColumnDataSource:
    first, last = float(part.beads[0]), float(part.beads[-1])
    step = float(part.time[1] - part.time[0]) if len(part.time) > 1 else 1.0
    arrays = {name: [getattr(part, name)[place].astype(np.float32)] for name in ("velocity", "overlap", "force")}
    half = 0.5 * part.bead_stride
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
    symbol: dict[str, str],
    sight: tuple[float, float],
) -> tuple[list[Any], Any, Any]:
    """Velocity in space and time, a plot for each chain, with linked axes and a cursor that says the numbers.

    Args:
        sight: beads that are seen at first.
    """
    across = min(PLOTS_A_ROW, len(part.chains))
    lists = {"beads": part.beads.tolist(), "time": part.time.tolist(), "stride": part.bead_stride}
    bead = CustomJSHover(args=lists, code="return '' + beads[Math.round((special_vars.x - beads[0]) / stride)]")
    time = CustomJSHover(
        args=lists,
        code="const k = time.length > 1 ? Math.round((special_vars.y - time[0]) / (time[1] - time[0])) : 0;"
        "return time[Math.max(0, Math.min(time.length - 1, k))].toPrecision(6)",
    )
    found: list[Any] = []
    for source, chain in zip(images, part.chains, strict=True):
        shared = {"x_range": found[0].x_range, "y_range": found[0].y_range} if found else {"x_range": sight}
        last = len(found) % across == across - 1
        plot = figure(
            title=f"chain {chain}",
            tools=_TOOLS,
            active_scroll="wheel_zoom",
            width=(_PAGE - _BAR) // across + (_BAR if last else 0),
            height=430,
            x_axis_label="bead",
            y_axis_label=f"time{symbol['time']}",
            **shared,
        )
        drawn = plot.image("velocity", x="x", y="y", dw="dw", dh="dh", source=source, color_mapper=colours)
        tips = [("bead", "$x{custom}"), ("time", "$y{custom}"), ("velocity", "@velocity{%.6g}")]
        if np.any(np.isfinite(part.overlap)):
            tips += [("overlap", "@overlap{%.6g}"), ("force", "@force{%.6g}")]
        told = {"$x": bead, "$y": time, "@velocity": "printf", "@overlap": "printf", "@force": "printf"}
        plot.add_tools(HoverTool(renderers=[drawn], tooltips=tips, formatters=told))
        plot.add_tools(CrosshairTool(line_alpha=0.4))
        plot.add_layout(now)
        plot.grid.visible = False
        _label(plot)
        if len(found) == across - 1:
            plot.add_layout(ColorBar(color_mapper=colours, title=f"velocity{symbol['velocity']}", width=10), "right")
        found.append(plot)
    return found, found[0].x_range, found[0].y_range


def _traces(part: Thinned, shown: list[int], time_range: Any, symbol: dict[str, str]) -> tuple[Any, ColumnDataSource]:
    """Velocity of some beads over time; a click into a map adds one."""
    data: dict[str, list[Any]] = {"xs": [], "ys": [], "label": [], "colour": []}
    for bead in shown[: max(1, 6 // len(part.chains))]:
        k = int(np.argmin(np.abs(part.beads - bead)))
        for place, chain in enumerate(part.chains[:8]):
            data["xs"].append(part.time.astype(np.float32))
            data["ys"].append(part.velocity[place, :, k].astype(np.float32))
            data["colour"].append(CHAIN_COLOURS[len(data["label"]) % len(CHAIN_COLOURS)])
            data["label"].append(f"bead {part.beads[k]}, chain {chain}")
    source = ColumnDataSource(name="traces", data=data)
    plot = _graph(
        "velocity over time; click into a map for another bead",
        f"time{symbol['time']}",
        f"velocity{symbol['velocity']}",
        (float(part.time[0]), float(part.time[-1])),
    )
    time_range.js_link("start", plot.x_range, "start")
    time_range.js_link("end", plot.x_range, "end")
    plot.multi_line("xs", "ys", source=source, line_color="colour", legend_field="label", line_width=1.5)
    plot.legend.label_text_font_size = "8pt"
    plot.legend.padding = 3
    plot.legend.background_fill_alpha = 0.6
    return plot, source


def _moving(
    problem: Problem, part: Thinned, images: list[ColumnDataSource], now: Span, colours: LinearColorMapper
) -> tuple[Any, Any]:
    """Beads, springs and contact forces at one time, with a slider and a button that moves it."""
    chains = len(part.chains)
    first = float(part.beads[0])
    sight = min(float(part.beads[-1]) + 1.0, first + BEADS_IN_SIGHT * part.bead_stride)
    plot = figure(
        tools="xpan,xwheel_zoom,reset,save",
        height=110 + 46 * chains,
        sizing_mode="stretch_width",
        x_range=(first - 1.0, sight),
        y_range=(-chains + 0.4, 0.9),
        x_axis_label=f"bead; displacements times {_EXAGGERATED:g} spacings / L, bars: contact force",
    )
    plot.yaxis.ticker = [-k for k in range(chains)]
    plot.yaxis.major_label_overrides = {-k: f"chain {chain}" for k, chain in enumerate(part.chains)}
    plot.grid.visible = False
    balls = ColumnDataSource(name="balls", data={"x": [], "y": [], "v": []})
    pushes = ColumnDataSource(name="pushes", data={"x": [], "y": [], "h": []})
    ties = ColumnDataSource(name="ties", data={"x0": [], "x1": [], "y0": [], "y1": [], "alpha": []})
    plot.segment("x0", "y0", "x1", "y1", source=ties, line_color="#7a5195", line_alpha="alpha", line_width=2)
    plot.rect("x", "y", width=0.35 * part.bead_stride, height="h", source=pushes, fill_color="#e69f00", line_color=None)
    drawn = plot.scatter(
        "x", "y", size=13, source=balls, fill_color={"field": "v", "transform": colours}, line_color="#555555"
    )
    plot.add_tools(
        HoverTool(
            renderers=[drawn], tooltips=[("at", "@x{0.000}"), ("velocity", "@v{%.6g}")], formatters={"@v": "printf"}
        )
    )
    moved = ColumnDataSource(
        name="moved", data={"displacement": [(x / problem.scale.length).astype(np.float32) for x in part.displacement]}
    )
    unit = f" {problem.scale.symbol('time')}" if problem.scale.si else ""
    told = CustomJSTickFormatter(args={"time": part.time.tolist(), "unit": unit}, code=_TIME)
    slider = Slider(start=0, end=max(1, len(part.time) - 1), value=0, step=1, title="time", name="time", format=told)
    slider.sizing_mode = "stretch_width"
    button = Button(label="play", width=70, name="play")
    places = {chain - 1: k for k, chain in enumerate(part.chains)}
    edges = [edge for link in problem.across for edge in link.edges if edge[0] in places and edge[1] in places]
    move = CustomJS(
        args={
            "slider": slider,
            "now": now,
            "beads": part.beads.tolist(),
            "time": part.time.tolist(),
            "images": images,
            "moved": moved,
            "balls": balls,
            "pushes": pushes,
            "ties": ties,
            "range": plot.x_range,
            "springs": [[places[one], places[other]] for one, other in edges],
            "strongest": float(np.nanmax(part.force, initial=0.0)) or 1.0,
            "exaggerated": _EXAGGERATED,
            "stride": part.bead_stride,
            "sight": BEADS_IN_SIGHT * part.bead_stride,
        },
        code=_MOVE,
    )
    slider.js_on_change("value", move)
    button.js_on_click(CustomJS(args={"slider": slider, "button": button}, code=_PLAY))
    plot.js_on_change("inner_width", move)  # once, when the page is laid out
    return plot, row(button, slider, sizing_mode="stretch_width")


def _distances(problem: Problem, part: Thinned, found: Survey, bead_range: Any, symbol: dict[str, str]) -> list[Any]:
    """Peak velocity, lag and energy of the leading pulse along the chains."""
    waves, scale = found.waves, problem.scale
    if not len(waves):
        return []
    peaks = _graph("peak velocity of the leading pulse", "bead", f"velocity{symbol['velocity']}", bead_range)
    hit = problem.hardest_blow[0]
    lags = _graph(f"arrival after that in chain {hit}", "bead", f"time{symbol['time']}", bead_range)
    reference = waves.of_chain(hit)
    drawn = []
    for place, chain in enumerate(part.chains):
        own = waves.of_chain(chain)
        if not len(own):
            continue
        style = _of_chain(place, chain)
        drawn.append(
            peaks.line("bead", "peak", source={"bead": own.bead, "peak": own.peak_velocity * scale.velocity}, **style)
        )
        both, mine, theirs = np.intersect1d(own.bead, reference.bead, return_indices=True)
        lag = (own.arrival[mine] - reference.arrival[theirs]) * scale.time
        lags.line(both, lag, **style)
    peaks.add_tools(HoverTool(renderers=drawn, tooltips=[("bead", "@bead"), ("peak velocity", "@peak{0.00000}")]))
    return [peaks, lags] if len(drawn) > 1 else [peaks]


def _energy(problem: Problem, part: Thinned, time_range: Any, symbol: dict[str, str]) -> Any:
    """Energy of the beads of each chain that is shown, with their contacts and what holds them, over time."""
    scale = problem.scale
    unit = f" ({scale.symbol('energy')})" if scale.si else ""
    heading = "energy of each chain, without the springs between chains"
    plot = _graph(heading, f"time{symbol['time']}", f"energy{unit}", time_range)
    for place, chain in enumerate(part.chains):
        plot.line(part.time, part.energy[place], **_of_chain(place, chain))
    return plot


def _graph(title: str, x: str, y: str, x_range: Any) -> Any:
    """A plot of lines, as wide as half of the page."""
    plot = figure(
        title=title, tools=_TOOLS, width=_PAGE // 2, height=330, x_axis_label=x, y_axis_label=y, x_range=x_range
    )
    plot.toolbar.logo = None
    _label(plot)
    return plot


def _label(plot: Any) -> None:
    """Write the numbers on axes as short as they are."""
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.formatter = CustomJSTickFormatter(code=_TICK)


def _of_chain(place: int, chain: int) -> dict[str, Any]:
    """How the line of a chain is drawn."""
    return {
        "line_color": CHAIN_COLOURS[place % len(CHAIN_COLOURS)],
        "legend_label": f"chain {chain}",
        "line_width": 1.5,
    }
