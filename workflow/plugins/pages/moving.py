"""Beads, springs, contact forces, walls and other atoms that move along the chains, under a slider."""

from typing import Any

import numpy as np
from bokeh.layouts import column
from bokeh.models import (
    ColumnDataSource,
    CustomJS,
    Div,
    HoverTool,
    LinearColorMapper,
    Range1d,
    Span,
)
from bokeh.plotting import figure

from granchain.parts import Floats, Problem, spacetime
from workflow.plugins.pages.attached import draw_others, draw_walls
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.plots import chain_name, label, label_of, lists, name_places, number
from workflow.plugins.pages.save_data import add_tool_of_columns
from workflow.plugins.pages.time_bar import time_bar
from workflow.plugins.pages.units import Units

BEADS_IN_SIGHT = 40
"""Around the front, where beads move."""

_WIDEST = 26
"""Pixels of the largest bead's diameter, where there is room."""

_EXAGGERATED = 0.25
"""Distances between neighbouring beads of a page for a displacement of L: what LAMMPS's, 4 wide, have."""

_MOVE = """
const sight = Math.min(most_places, places.at(-1) - places[0] + 2 * spacing);
const widest = Math.min(most_pixels, 0.95 * spacing * plot.inner_width / sight);
const n = places.length, k = Math.min(time.length - 1, Math.round((slider.value - slider.start) / slider.step));
for (const line of now) line.location = time[k];
const x = [], y = [], v = [], d = [], r = [], bead = [], chain = [], fx = [], fy = [], fh = [];
const sx0 = [], sx1 = [], sy0 = [], sy1 = [], sc = [];
let front = 0, fastest = 0;
for (let c = 0; c < images.length; c++) {
  const {velocity: [vel], force: [force], displacement: [dis]} = images[c].data;
  for (let i = 0; i < n; i++) {
    const at = k * n + i;
    r.push(widest * radius[c][i]); x.push(places[i] + exaggerated * dis[at]); y.push(-c); v.push(vel[at]);
    d.push(dis[at]); bead.push(beads[i]); chain.push(chains[c]);
    if (force[at] > least) {
      fx.push(places[i] + 0.5 * spacing); fy.push(-c + 0.3); fh.push(0.45 * force[at] / strongest);
    }
    if (Math.abs(vel[at]) > fastest) { fastest = Math.abs(vel[at]); front = i; }
  }
}
for (const [a, b] of springs)
  for (let i = 0; i < n; i++) {
    const at = k * n + i, [p, q] = [a, b].map(c => exaggerated * images[c].data.displacement[0][at]);
    sx0.push(places[i] + p); sx1.push(places[i] + q);
    sy0.push(-a); sy1.push(-b); sc.push(Math.min(1, 0.15 + Math.abs(p - q) / spacing));
  }
balls.data = {x, y, v, d, r, bead, chain};
pushes.data = {x: fx, y: fy.map((low, i) => low + fh[i] / 2), h: fh};
ties.data = {x0: sx0, x1: sx1, y0: sy0, y1: sy1, alpha: sc};
const half = 0.5 * most_places, first = places[0] - spacing, last = places[n - 1] + spacing;
const middle = Math.max(first + half, Math.min(last - half, places[front]));
if (last - first > most_places) { range.start = middle - half; range.end = middle + half; }
"""


_SEEN = """
const seen = beads.filter((bead, i) => places[i] >= range.start && places[i] <= range.end);
title.text = seen.length < beads.length && seen.length ? `beads ${seen[0]} to ${seen.at(-1)} of ${total}` : '';
"""
"""Title: which beads are in sight, where not all are."""


def moving_beads(
    problem: Problem,
    part: Thinned,
    images: list[ColumnDataSource],
    now: list[Span],
    colours: LinearColorMapper,
    units: Units,
    radius: Floats,
) -> tuple[Any, Any]:
    """Beads, springs and contact forces at one time, with a slider and a button that moves it.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        images: maps of the chains.
        now: lines that mark the time in other plots.
        colours: of velocities.
        units: of the page.
        radius: of each bead of the part, [chain, bead], over the largest.
    """
    sight = BEADS_IN_SIGHT * part.spacing
    plot = _plot(part, sight)
    _name_seen(problem, plot, part)
    sources = _drawn(problem, plot, part, colours, units)
    exaggerated = _EXAGGERATED * part.spacing / units["length"].worth
    slider, bar = time_bar(part, units["time"])
    least = spacetime.RootScale(colours.high).least / units["velocity"].worth * units["force"].worth
    strongest = float(np.nanmax(part.force, initial=0.0))
    move = CustomJS(
        args={
            "slider": slider,
            "now": now,
            **lists(part),
            "images": images,
            **sources,
            "range": plot.x_range,
            "springs": _springs(problem, part),
            "least": least,
            "strongest": strongest,
            "exaggerated": exaggerated,
            "spacing": part.spacing,
            "most_places": sight,
            "plot": plot,
            "radius": radius.tolist(),
            "most_pixels": _WIDEST,
        },
        code=_MOVE,
    )
    slider.js_on_change("value", move)
    others = problem.system.others
    drawn = draw_others(plot, others, part, slider, exaggerated, (sight, _WIDEST))
    plot.js_on_change("inner_width", move)  # once, when the page is laid out
    dragged = "; dragged sideways, the picture shows other beads" if len(part.beads) > BEADS_IN_SIGHT else ""
    further = {
        "hatched": "walls" if draw_walls(plot, problem, part) else "",
        "small circles": others if drawn else "",
    }
    words = "".join(f"; {look}: {name}" for look, name in further.items() if name) + dragged
    scales = Div(text=_scales(part, units, strongest if strongest > least else 0.0, words))
    return plot, column(bar, scales, sizing_mode="stretch_width")


def _springs(problem: Problem, part: Thinned) -> list[list[int]]:
    """Pairs of the chains shown, counted from 0 in their order, between which there are springs."""
    rows = {chain - 1: k for k, chain in enumerate(part.chains)}
    edges = (edge for link in problem.system.couplings for edge in link.edges)
    return [[rows[first], rows[second]] for first, second in edges if first in rows and second in rows]


def _scales(part: Thinned, units: Units, strongest: float, further: str) -> str:
    """How velocities, displacements and forces are drawn, and in further words what else."""
    length, force = units["length"], units["force"]
    unit = f"{length.worth:.3g} {length.symbol} (L)" if length.behind else "L (the unit of length)"
    between = "neighbouring beads" if part.bead_stride == 1 and part.even else "the beads shown"
    forces = f"; bars above the beads: contact forces, the highest {strongest:.3g}{force.behind}" if strongest else ""
    displacements = f"a displacement of {unit} is drawn as {_EXAGGERATED:g} of the distance between {between}"
    return f"Colours follow the signed square root of the velocity; {displacements}{forces}{further}."


def _plot(part: Thinned, sight: float) -> Any:
    """Axes along the chains and across them."""
    chains = len(part.chains)
    first, last = float(part.places[0]) - part.spacing, float(part.places[-1]) + part.spacing
    plot = figure(
        name="beads",
        tools="xpan,xwheel_zoom,reset,save",
        toolbar_location="above",
        toolbar_sticky=False,
        height=130 + 46 * chains,
        sizing_mode="stretch_width",
        x_range=Range1d(first, min(last, first + sight), bounds=(first, last)),
        y_range=(-chains + 0.4, 0.9),
    )
    plot.toolbar.logo = None
    label(plot)
    name_places(plot, part)
    plot.yaxis.ticker = [-k for k in range(chains)]
    plot.yaxis.major_label_overrides = {-k: chain_name(chain) for k, chain in enumerate(part.chains)}
    plot.grid.visible = False
    return plot


def _name_seen(problem: Problem, plot: Any, part: Thinned) -> None:
    """Let the title of a plot say which beads are in sight where not all are, also when it is moved."""
    numbers = lists(part)
    arguments = {"range": plot.x_range, "title": plot.title, "total": problem.beads}
    name = CustomJS(args={**arguments, "beads": numbers["beads"], "places": numbers["places"]}, code=_SEEN)
    for end in ("start", "end"):
        plot.x_range.js_on_change(end, name)
    plot.js_on_change("inner_width", name)  # once, when the page is laid out


def _drawn(
    problem: Problem, plot: Any, part: Thinned, colours: LinearColorMapper, units: Units
) -> dict[str, ColumnDataSource]:
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
    heads = {"chain": "chain", "bead": "bead", label_of("displacement", units): "d", label_of("velocity", units): "v"}
    add_tool_of_columns(plot, problem.name, balls, heads)
    return {"balls": balls, "pushes": pushes, "ties": ties}
