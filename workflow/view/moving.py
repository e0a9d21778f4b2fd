"""Beads, springs and contact forces that move along the chains, under a slider."""

from typing import Any

import numpy as np
from bokeh.layouts import column, row
from bokeh.models import (
    ColumnDataSource,
    CustomJS,
    CustomJSTickFormatter,
    Div,
    HoverTool,
    LinearColorMapper,
    Slider,
    Span,
    Toggle,
)
from bokeh.plotting import figure

from analysis.figures.style import Unit
from analysis.trajectory import Floats
from lammps_inputs import Problem
from workflow.view.plots import label, name_places, number
from workflow.view.thin import Thinned, Units, behind

BEADS_IN_SIGHT = 40
"""Around the front, where beads move."""

_WIDEST = 26
"""Pixels of the largest bead's diameter, where there is room."""

_EXAGGERATED = 0.25
"""Distances between neighbouring beads of a page for a displacement of L: what LAMMPS's, 4 wide, have."""

_MOVE = """
const seen = Math.min(sight, places.at(-1) - places[0] + 2 * spacing);
const widest = Math.min(most, 0.95 * spacing * plot.inner_width / seen);
const k = slider.value, n = places.length, T = time[k];
now.location = T;
const x = [], y = [], v = [], d = [], r = [], bead = [], chain = [], fx = [], fy = [], fh = [];
const sx0 = [], sx1 = [], sy0 = [], sy1 = [], sc = [];
let front = 0, fastest = 0;
for (let c = 0; c < images.length; c++) {
  const vel = images[c].data.velocity[0], force = images[c].data.force[0], dis = moved.data.displacement[c];
  for (let i = 0; i < n; i++) {
    const at = k * n + i;
    r.push(widest * radius[c][i]); x.push(places[i] + exaggerated * dis[at]); y.push(-c); v.push(vel[at]);
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
balls.data = {x, y, v, d, r, bead, chain};
pushes.data = {x: fx, y: fy.map((low, i) => low + fh[i] / 2), h: fh};
ties.data = {x0: sx0, x1: sx1, y0: sy0, y1: sy1, alpha: sc};
const half = 0.5 * sight, first = places[0] - spacing, last = places[n - 1] + spacing;
const middle = Math.max(first + half, Math.min(last - half, places[front]));
if (last - first > sight) { range.start = middle - half; range.end = middle + half; }
"""

_TIME = "return time[Math.max(0, Math.min(time.length - 1, Math.round(tick)))].toPrecision(5) + unit"

_PLAY_LABEL = """
.bk-btn::after { content: 'play'; } .bk-btn.bk-active::after { content: 'pause'; }
"""
"""A label that is changed in the model draws the button again, which takes the focus from it."""

_PLAY = """
clearInterval(window.playing);
if (button.active) window.playing = setInterval(() => {
  slider.value = slider.value >= slider.end ? slider.start : slider.value + Math.max(1, Math.round(slider.end / 400));
}, 40);
"""


def moving_beads(
    problem: Problem,
    part: Thinned,
    images: list[ColumnDataSource],
    now: Span,
    colours: LinearColorMapper,
    units: Units,
    radius: Floats,
) -> tuple[Any, Any]:
    """Beads, springs and contact forces at one time, with a slider and a button that moves it.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        images: maps of the chains.
        now: marks the time in them.
        colours: of velocities.
        units: of the page.
        radius: of each bead of the part, [chain, bead], over the largest.
    """
    sight = BEADS_IN_SIGHT * part.spacing
    plot = _plot(part, sight)
    sources = _drawn(plot, part, colours, units)
    length = units["length"].worth
    moved = ColumnDataSource(
        name="moved", data={"displacement": [(x / length).astype(np.float32) for x in part.displacement]}
    )
    shown = CustomJSTickFormatter(args={"time": part.time.tolist(), "unit": behind(units["time"])}, code=_TIME)
    slider = Slider(start=0, end=max(1, len(part.time) - 1), value=0, step=1, title="time", name="time", format=shown)
    slider.sizing_mode = "stretch_width"
    button = Toggle(label="", width=70, name="play", stylesheets=[_PLAY_LABEL])
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
            **sources,
            "range": plot.x_range,
            "springs": _springs(problem, part),
            "strongest": float(np.nanmax(part.force, initial=0.0)) or 1.0,
            "exaggerated": _EXAGGERATED * part.spacing,
            "length": length,
            "spacing": part.spacing,
            "sight": sight,
            "plot": plot,
            "radius": radius.tolist(),
            "most": _WIDEST,
        },
        code=_MOVE,
    )
    slider.js_on_change("value", move)
    button.js_on_change("active", CustomJS(args={"slider": slider, "button": button}, code=_PLAY))
    plot.js_on_change("inner_width", move)  # once, when the page is laid out
    bar = row(button, slider, sizing_mode="stretch_width")
    return plot, column(bar, Div(text=_scales(part, units["length"])), sizing_mode="stretch_width")


def _springs(problem: Problem, part: Thinned) -> list[list[int]]:
    """Pairs of the chains shown, counted from 0 in their order, between which there are springs."""
    rows = {chain - 1: k for k, chain in enumerate(part.chains)}
    edges = (edge for link in problem.system.across for edge in link.edges)
    return [[rows[one], rows[other]] for one, other in edges if one in rows and other in rows]


def _scales(part: Thinned, length: Unit) -> str:
    """How displacements and forces are drawn."""
    unit = f"{length.worth:.3g} {length.symbol} (L)" if length.symbol else "L (the unit of length)"
    between = "neighbouring beads" if part.bead_stride == 1 and part.even else "the beads shown"
    forces = "; bars above the beads: contact forces" if np.any(np.isfinite(part.force)) else ""
    return f"A displacement of {unit} is drawn as {_EXAGGERATED:g} of the distance between {between}{forces}."


def _plot(part: Thinned, sight: float) -> Any:
    """Axes along the chains and across them."""
    chains = len(part.chains)
    first, last = float(part.places[0]) - part.spacing, float(part.places[-1]) + part.spacing
    plot = figure(
        tools="xpan,xwheel_zoom,reset,save",
        height=110 + 46 * chains,
        sizing_mode="stretch_width",
        x_range=(first, min(last, first + sight)),
        y_range=(-chains + 0.4, 0.9),
    )
    label(plot)
    name_places(plot, part)
    plot.yaxis.ticker = [-k for k in range(chains)]
    plot.yaxis.major_label_overrides = {-k: f"chain {chain}" for k, chain in enumerate(part.chains)}
    plot.grid.visible = False
    return plot


def _drawn(plot: Any, part: Thinned, colours: LinearColorMapper, units: Units) -> dict[str, ColumnDataSource]:
    """What of beads, contact forces and springs is drawn in a plot, by the name in the script that moves them."""
    balls = ColumnDataSource(name="balls", data={name: [] for name in ("x", "y", "v", "d", "r", "bead", "chain")})
    pushes = ColumnDataSource(name="pushes", data={"x": [], "y": [], "h": []})
    ties = ColumnDataSource(name="ties", data={"x0": [], "x1": [], "y0": [], "y1": [], "alpha": []})
    plot.segment("x0", "y0", "x1", "y1", source=ties, line_color="#7a5195", line_alpha="alpha", line_width=2)
    plot.rect("x", "y", width=0.35 * part.spacing, height="h", source=pushes, fill_color="#e69f00", line_color=None)
    drawn = plot.scatter(
        "x", "y", size="r", source=balls, fill_color={"field": "v", "transform": colours}, line_color="#555555"
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
            formatters={"@d": number(units["length"]), "@v": number(units["velocity"])},
        )
    )
    return {"balls": balls, "pushes": pushes, "ties": ties}
