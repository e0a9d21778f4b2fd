"""The page of a run: its plots, and where they stand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.layouts import column, gridplot, row
from bokeh.models import CheckboxGroup, ColumnDataSource, CustomJS, Div, HoverTool, Range1d

from granchain.parts import Fact, Floats, Integers, Problem, Survey, leading_waves, physics, spacetime
from workflow.plugins.pages.downsample import Thinned, units_of
from workflow.plugins.pages.map_choice import map_choice
from workflow.plugins.pages.measured import plots_of
from workflow.plugins.pages.moving import moving_beads
from workflow.plugins.pages.plots import (
    MARKS,
    NOW,
    add_legend,
    chain_name,
    ends,
    graph,
    image_source,
    largest,
    look,
    maps_of,
    mark,
    number,
    root_colours,
)
from workflow.plugins.pages.save_data import add_tool_of_curves
from workflow.plugins.pages.selection import selection
from workflow.plugins.pages.theory import along, draw_lines, lines_of, peaks_of
from workflow.plugins.pages.traces import TracePlot
from workflow.plugins.pages.units import Units

# --- graphs over beads ------------------------------------------------------------------------------------------------


_THEORY_COLOURS = ("#888888", "#00a651")


def distances(problem: Problem, part: Thinned, survey: Survey, bead_range: Range1d, units: Units) -> list[Any]:
    """Peak velocity and lag of the leading pulse along the chains, and impulses where chains are compared by them."""
    waves, time, velocity = survey.waves, units["time"], units["velocity"]
    if not len(waves):
        return []
    kicked = physics.largest_excitation(problem.system)[0]
    of_chain = {chain: waves.of_chain(chain) for chain in part.chains}
    peaks = {
        chain: _pulse_by_pulse(passed, passed.peak_velocity * velocity.worth) for chain, passed in of_chain.items()
    }
    lags = {chain: _lag(passed, waves.of_chain(kicked), time.worth) for chain, passed in of_chain.items()}
    title = "peak velocity of the leading pulse"
    theory = {name: (bead, value * velocity.worth) for name, (bead, value) in peaks_of(problem, survey).items()}
    plot = graph(title, "peaks", units, "velocity", bead_range, "bead")
    graphs = [_draw_over_beads(plot, problem, "velocity", peaks, units, theory=theory)]
    if sum(len(passed) > 0 for passed in of_chain.values()) > 1:
        title = f"arrival after that in {chain_name(kicked)}"
        plot = graph(title, "arrivals", units, "time", bead_range, "bead")
        graphs.append(_draw_over_beads(plot, problem, "time", lags, units))
    shared = survey.shared
    if shared.of_impulses:
        bead = along(survey, shared.bead)
        impulses = {chain: (bead, shared.amplitude[:, chain - 1] * velocity.worth) for chain in part.chains}
        title = "impulse of the first contact, over the mass"
        plot = graph(title, "impulses", units, "velocity", bead_range, "bead")
        graphs.append(_draw_over_beads(plot, problem, "velocity", impulses, units))
    return graphs


def _pulse_by_pulse(waves: leading_waves.Waves, values: Floats) -> tuple[Floats, Floats]:
    """Beads and values of a chain's leading waves, with NaN half a bead behind the end of each pulse but the last."""
    at = waves.ends + 1
    return np.insert(waves.bead.astype(np.float64), at, waves.bead[at - 1] + 0.5), np.insert(values, at, np.nan)


def _lag(waves: leading_waves.Waves, reference: leading_waves.Waves, worth: float) -> tuple[Integers, Floats]:
    """Beads that two chains' waves passed, and the time from one to the other."""
    both, mine, theirs = np.intersect1d(waves.bead, reference.bead, return_indices=True)
    return both, (waves.arrival[mine] - reference.arrival[theirs]) * worth


def _draw_over_beads(
    plot: Any,
    problem: Problem,
    quantity: str,
    values: Mapping[int, tuple[Integers | Floats, Floats]],
    units: Units,
    *,
    theory: Mapping[str, tuple[Floats, Floats]] | None = None,
) -> Any:
    """Draw a quantity over the beads, a line for each chain, broken where a recorded bead has no value.

    Args:
        plot: to draw in.
        problem: what was run.
        quantity: key of its unit.
        values: by chain: beads, and their values in units of the page.
        units: of the page.
        theory: beads and values of lines of theory, by name.

    Returns:
        The plot.
    """
    items = []
    for place, (chain, (bead, value)) in enumerate(values.items()):
        if not len(bead):
            continue
        line, alone = _broken(problem, bead, value)
        style = look(place)
        drawn = [plot.line("bead", "value", source=ColumnDataSource(line), name=chain_name(chain), **style)]
        if len(alone["bead"]):
            source, colour = ColumnDataSource(alone), style["line_color"]
            drawn.append(plot.scatter("bead", "value", source=source, size=4, color=colour, name=chain_name(chain)))
        items.append((chain_name(chain), drawn))
    tips = [("bead", "@bead"), (quantity, "@value{custom}")]
    renderers = [glyph for _, drawn in items for glyph in drawn]
    plot.add_tools(HoverTool(renderers=renderers, tooltips=tips, formatters={"@value": number(units[quantity])}))
    for line_name, (bead, value) in (theory or {}).items():
        style = {"line_color": _THEORY_COLOURS[len(items) % 2], "line_dash": "dotted", "line_width": 2}
        items.append((line_name, [plot.line(bead, value, name="theory", **style)]))
    add_legend(plot, items)
    return plot


def _broken(problem: Problem, bead: Integers | Floats, value: Floats) -> tuple[dict[str, Any], dict[str, Any]]:
    """Values over beads with NaN at recorded beads between them that have none; and those that stand alone."""
    between = problem.rows.numbers[(problem.rows.numbers > bead[0]) & (problem.rows.numbers < bead[-1])]
    every = np.union1d(bead, between)
    values = np.full(len(every), np.nan)
    values[np.searchsorted(every, bead)] = value
    finite = np.pad(np.isfinite(values), 1)
    alone = finite[1:-1] & ~finite[:-2] & ~finite[2:]
    return {"bead": every, "value": values}, {"bead": every[alone], "value": values[alone]}


# --- graphs over time -------------------------------------------------------------------------------------------------

_LEAST_SPAN = 0.02
"""Least range of an axis of energy, over the largest energy; less would show the error of the run."""


def energy(part: Thinned, time_range: Range1d, units: Units) -> Any:
    """Energy of the beads of each chain that is shown, with their contacts and what holds them, over time."""
    plot = graph("energy of each chain, without coupling", "energy", units, "energy", time_range)
    plot.y_range.min_interval = _LEAST_SPAN * float(np.max(part.energy))
    items = []
    for place, chain in enumerate(part.chains):
        line = plot.line(part.time, part.energy[place], name=chain_name(chain), **look(place))
        items.append((chain_name(chain), [line]))
    add_legend(plot, items)
    return plot


_MOST_INSTANTS = 4000
"""Instants of a force over time that are drawn at most."""


@dataclass(frozen=True)
class ForceLine:
    """A force over time.

    Attributes:
        name: in the legend.
        values: [instant], dimensionless.
        chain: that it acts in.
        place: of the chain among those that are shown.
        item: number of the gauge or load.
    """

    name: str
    values: Floats
    chain: int
    place: int
    item: int


def forces(problem: Problem, part: Thinned, readings: Any, time_range: Range1d, units: Units) -> list[Any]:
    """Forces that gauges read, a line for each and each chain that is shown, and those that push and drive beads.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        readings: of the measurement ``forces``; None where there are no gauges.
        time_range: of the axis.
        units: of the page.
    """
    graphs, time = [], part.time / units["time"].worth
    if readings is not None:
        title = "total force at gauges" if readings.loaded else "force at gauges"
        stride = slice(None, None, -(-len(readings.time) // _MOST_INSTANTS))
        lines = [
            ForceLine(f"{gauge.name}, {chain_name(chain)}", readings.force[stride, chain - 1, item], chain, place, item)
            for item, gauge in enumerate(readings.gauges[: len(MARKS)])
            for place, chain in enumerate(part.chains)
        ]
        graphs.append(_forces(title, "forces", readings.time[stride], lines, time_range, units))
    if loads := problem.system.loads[: len(MARKS)]:
        lines = [
            ForceLine(
                f"bead {load.bead}, {chain_name(load.chain)}",
                np.array([load.force(t) for t in time]),
                load.chain,
                item,
                0,
            )
            for item, load in enumerate(loads)
        ]
        graphs.append(_forces("external force on beads", "external-forces", time, lines, time_range, units))
    return graphs


def _forces(title: str, name: str, time: Floats, lines: Sequence[ForceLine], time_range: Range1d, units: Units) -> Any:
    """A plot of forces: colour and dashes are the chain's and the mark is the gauge's, or all are the gauge's."""
    force, instants = units["force"], time * units["time"].worth
    plot = graph(title, name, units, "force", time_range)
    several_chains = len({line.place for line in lines}) > 1
    several_items = len({line.item for line in lines}) > 1
    items, curves = [], []
    for line in lines:
        values = line.values * force.worth
        source = ColumnDataSource({"time": instants, "force": values})
        style = look(line.place if several_chains else line.item)
        curves.append(plot.line("time", "force", source=source, name=chain_name(line.chain), **style))
        drawn = [curves[-1]]
        if several_chains and several_items:
            points = ColumnDataSource(largest(instants, values))
            drawn.append(mark(plot, points, line.place, line.item))
            drawn[-1].name = chain_name(line.chain)
        items.append((line.name, drawn))
    tips = [("time", "@time{custom}"), ("force", "@force{custom}")]
    formatters = {"@time": number(units["time"]), "@force": number(force)}
    plot.add_tools(HoverTool(renderers=curves, tooltips=tips, formatters=formatters))
    add_legend(plot, items)
    return plot


# --- layout -----------------------------------------------------------------------------------------------------------

_NARROWEST = 480
"""Pixels of a plot of lines; two stand side by side where there is room."""

BAR, TIME_AXIS = 70, 55
"""Pixels of the bar of colours beside the last map of a row, and of the axis beside the first."""


def layout(
    problem: Problem,
    part: Thinned,
    survey: Survey | None,
    shown: list[int],
    *,
    measurements: Mapping[str, Any] | None = None,
    radius: Floats | None = None,
) -> Any:
    """The plots of a page.

    Args:
        problem: what was run.
        part: of its frames, dimensionless.
        survey: the waves in it; None where there are none.
        shown: beads whose velocity over time is drawn first.
        measurements: what else was measured, by its key.
        radius: of every bead, [chain, bead]; all are alike without it.
    """
    units = units_of(problem, part)
    part, measured = part.measured(units), measurements or {}
    images = [image_source(part, place) for place in range(len(part.chains))]
    scale = spacetime.RootScale.of(problem, part.beads, part.velocity)
    all_places = ends(part.places, part.spacing)
    place_range = Range1d(*scale.moving_part(part.velocity, part.places, all_places), bounds=all_places)
    time_range = Range1d(*ends(part.time, part.every), bounds=ends(part.time, part.every))
    of_maps = root_colours(scale.limit)
    maps = maps_of(problem, part, images, of_maps, units, (place_range, time_range))
    every_map = [plot for line in maps for plot in line]
    grid = _side_by_side(maps)
    above = [map_choice(problem, part, units, every_map, of_maps, grid.toolbar)]
    if survey is not None and (lines := lines_of(problem, part.chains, survey, measured)):
        above.append(draw_lines(lines, part, every_map, units))
    phase = part.frame_stride == 1 and not problem.system.holds(Fact.PULSE)
    moving = part.beads[scale.moves(part.velocity)]
    first_shown = _that_move(moving if len(moving) else part.beads, shown)
    traces = TracePlot(part, first_shown, time_range, units, phase=phase)
    traces.follow(every_map, images)
    below = [*traces.plots, *_graphs(problem, part, survey, measured, (place_range, time_range), units)]
    for plot in below:
        add_tool_of_curves(plot, problem.name)
    further = plots_of(problem, part, measured, time_range, units)
    plots = [*every_map, *below, *further]
    now = dict.fromkeys(line for plot in plots for line in plot.center if line.name == NOW)
    every = np.ones((problem.chains, problem.beads)) if radius is None else radius / np.max(radius)
    sizes = every[np.ix_(np.array(part.chains) - 1, part.beads - 1)]
    moving, controls = moving_beads(problem, part, images, list(now), root_colours(scale.limit), units, sizes)
    slider = controls.select_one({"name": "time"})
    link, readout = selection(part, units, every_map, slider, traces.bead, traces.chain)
    chosen = row(traces.choices, link, sizing_mode="stretch_width", styles={"flex-wrap": "wrap", "align-items": "end"})
    boxes = [_shown_chains(part.chains, [*below, *further])] if len(part.chains) > 1 else []
    graphs = [*below, *further]
    for graph_below in graphs:
        graph_below.styles = {"flex": f"1 1 {_NARROWEST}px"}
    wrapped = row(*graphs, styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")
    return column(*above, grid, controls, chosen, readout, moving, *boxes, wrapped, sizing_mode="stretch_width")


def _graphs(
    problem: Problem,
    part: Thinned,
    survey: Survey | None,
    measurements: Mapping[str, Any],
    ranges: tuple[Range1d, Range1d],
    units: Units,
) -> list[Any]:
    """Forces over time, the leading pulse over the beads, and energies over time, of what there is.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        survey: the waves in it; None where there are none.
        measurements: what else was measured, by its key.
        ranges: of the places of beads and of time.
        units: of the page.
    """
    place_range, time_range = ranges
    gauges = measurements.get("forces")
    graphs = forces(problem, part, None if gauges is None else gauges.readings, time_range, units)
    if survey is not None and problem.system.holds(Fact.PULSE):
        all_beads = (float(part.beads[0]) - 1.0, float(part.beads[-1]) + 1.0)
        bead_range = place_range if part.even else Range1d(*all_beads, bounds=all_beads)
        graphs += distances(problem, part, survey, bead_range, units)
    if problem.rows.complete:
        graphs.append(energy(part, time_range, units))
    return graphs


def _that_move(beads: Integers, shown: Sequence[int]) -> list[int]:
    """Beads to show at first: those asked for that move, or others that do in their place."""
    at = [
        bead if bead in beads else int(beads[share * (len(beads) - 1) // 6])
        for bead, share in zip(shown, (1, 3, 5), strict=False)
    ]
    return sorted(set(at))


def _shown_chains(chains: list[int], graphs: list[Any]) -> Any:
    """Boxes, one for each chain, which hide it in all graphs."""
    names = [chain_name(chain) for chain in chains]
    boxes = CheckboxGroup(
        labels=names,
        active=list(range(len(chains))),
        inline=True,
        name="chains",
        stylesheets=[".bk-input-group { flex-wrap: wrap; }"],
        sizing_mode="stretch_width",
    )
    drawn = [[line for plot in graphs for line in plot.renderers if line.name == name] for name in names]
    code = "drawn.forEach((lines, k) => lines.forEach(line => line.visible = boxes.active.includes(k)))"
    boxes.js_on_change("active", CustomJS(args={"drawn": drawn, "boxes": boxes}, code=code))
    return row(Div(text="Shown below:"), boxes, sizing_mode="stretch_width")


def _side_by_side(maps: list[list[Any]]) -> Any:
    """The maps of the chains in rows; a narrow page makes all of them narrower."""
    across = len(maps[0])
    grid = gridplot(
        maps,
        toolbar_location="above",
        toolbar_options={"logo": None},
        sizing_mode="stretch_width",
    )
    grid.name = "map-velocity"
    width = f"(100% - {BAR + TIME_AXIS}px) / {across}"
    if across > 1:
        grid.cols = [f"calc({width} + {TIME_AXIS}px)", *[f"calc({width})"] * (across - 2), "1fr"]
    return grid
