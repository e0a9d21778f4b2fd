"""The page of a run: its plots, and where they stand."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.layouts import column, gridplot, row
from bokeh.models import HoverTool, Span

from analysis.figures.spacetime import STILL, largest_afar, moving_part
from analysis.gauges.forces import Readings
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from workflow.view.moving import moving_beads
from workflow.view.plots import (
    BEAD_DASHES,
    CHAIN_COLOURS,
    PLOTS_A_ROW,
    graph,
    image_source,
    maps_of,
    number,
    of_chain,
    on_click,
    put_legend_aside,
    root_colours,
    traces_of,
)
from workflow.view.thin import Thinned, Units, units_of


def distances(problem: Problem, part: Thinned, found: Survey, bead_range: Any, units: Units) -> list[Any]:
    """Peak velocity, lag and energy of the leading pulse along the chains."""
    waves, time, velocity = found.waves, units["time"], units["velocity"]
    if not len(waves):
        return []
    peaks = graph("peak velocity of the leading pulse", units, "velocity", bead_range, "bead")
    hit = physics.largest_excitation(problem.system)[0]
    lags = graph(f"arrival after that in chain {hit}", units, "time", bead_range, "bead")
    reference = waves.of_chain(hit)
    drawn = []
    for place, chain in enumerate(part.chains):
        own = waves.of_chain(chain)
        if not len(own):
            continue
        style = of_chain(place, chain)
        at = own.ends + 1  # between two pulses, where no line is drawn
        peak = {
            "bead": np.insert(own.bead.astype(np.float64), at, np.nan),
            "peak": np.insert(own.peak_velocity * velocity.worth, at, np.nan),
        }
        drawn.append(peaks.line("bead", "peak", source=peak, **style))
        both, mine, theirs = np.intersect1d(own.bead, reference.bead, return_indices=True)
        lags.line(both, (own.arrival[mine] - reference.arrival[theirs]) * time.worth, **style)
    tips = [("bead", "@bead"), ("peak velocity", "@peak{custom}")]
    peaks.add_tools(HoverTool(renderers=drawn, tooltips=tips, formatters={"@peak": number(velocity)}))
    graphs = [peaks, lags] if len(drawn) > 1 else [peaks]
    for plot in graphs:
        put_legend_aside(plot)
    return graphs


_LEAST_SPAN = 0.02
"""Of an axis of energy, over the largest; less would show the error of the run."""


def energy(part: Thinned, time_range: Any, units: Units) -> Any:
    """Energy of the beads of each chain that is shown, with their contacts and what holds them, over time."""
    plot = graph("energy of each chain, without coupling", units, "energy", time_range)
    plot.y_range.min_interval = _LEAST_SPAN * float(np.max(part.energy))
    for place, chain in enumerate(part.chains):
        plot.line(part.time, part.energy[place], **of_chain(place, chain))
    put_legend_aside(plot)
    return plot


_NARROWEST = 480
"""Pixels of a plot of lines; two stand side by side where there is room."""

_BAR = 70
"""Width of the bar of colours."""


_MOST_INSTANTS = 4000
"""Of a force over time."""


def forces(problem: Problem, part: Thinned, readings: Readings | None, time_range: Any, units: Units) -> list[Any]:
    """Forces that gauges read, a line for each and each chain that is shown, and those that push and drive beads."""
    graphs, time = [], part.time / units["time"].worth
    if readings is not None:
        total = "total force" if readings.loaded else "force"
        stride = slice(None, None, -(-len(readings.time) // _MOST_INSTANTS))
        lines = [
            (f"{gauge.name}, chain {chain}", readings.force[stride, chain - 1, place], k, place)
            for place, gauge in enumerate(readings.gauges[: len(BEAD_DASHES)])
            for k, chain in enumerate(part.chains)
        ]
        graphs.append((f"{total} at gauges", readings.time[stride], lines))
    pushed = [(f"bead {one.bead}, chain {one.chain}", one, k, 0) for k, one in enumerate(problem.system.loads[:8])]
    if pushed:
        lines = [(name, np.array([one.force(t) for t in time]), k, dash) for name, one, k, dash in pushed]
        graphs.append(("external force on beads", time, lines))
    return [_forces(heading, at, lines, time_range, units) for heading, at, lines in graphs]


def _forces(
    heading: str, time: Floats, lines: Sequence[tuple[str, Floats, int, int]], time_range: Any, units: Units
) -> Any:
    """A plot of forces; name, values, colour and dash of each."""
    force = units["force"]
    plot = graph(heading, units, "force", time_range)
    one_chain = len({colour for _, _, colour, _ in lines}) == 1
    drawn = []
    for name, values, colour, dash in lines:
        look = {"line_color": CHAIN_COLOURS[dash if one_chain else colour], "line_dash": BEAD_DASHES[dash]}
        source = {"time": time * units["time"].worth, "force": values * force.worth}
        drawn.append(plot.line("time", "force", source=source, legend_label=name, line_width=1.5, **look))
    tips = [("time", "@time{custom}"), ("force", "@force{custom}")]
    said = {"@time": number(units["time"]), "@force": number(force)}
    plot.add_tools(HoverTool(renderers=drawn, tooltips=tips, formatters=said))
    put_legend_aside(plot)
    return plot


def layout(
    problem: Problem,
    part: Thinned,
    found: Survey | None,
    shown: list[int],
    *,
    readings: Readings | None = None,
    radius: Floats | None = None,
) -> Any:
    """The plots of a page.

    Args:
        problem: what was run.
        part: of its frames, dimensionless.
        found: the waves in it; None where there are none.
        shown: beads whose velocity over time is drawn first.
        readings: of the gauges that the scene asks for.
        radius: of every bead, [chain, bead]; all are alike without it.
    """
    units = units_of(problem, part)
    part = part.measured(units)
    images = [image_source(part, place) for place in range(len(part.chains))]
    now = Span(dimension="width", location=float(part.time[0]), line_color="#d55e00", line_width=1.5)
    largest = largest_afar(problem, part.beads, part.velocity)
    colours = root_colours(largest)
    moved = np.nanmax(np.abs(part.velocity), axis=(0, 1), initial=0.0) > STILL * largest
    half = 0.5 * part.spacing
    whole = (float(part.places[0]) - half, float(part.places[-1]) + half)
    maps, place_range, time_range = maps_of(part, images, now, colours, units, moving_part(part.places, moved, whole))
    there = part.beads[moved] if moved.any() else part.beads
    shown = [
        bead if bead in there else int(there[share * (len(there) - 1) // 6])
        for bead, share in zip(shown, (1, 3, 5), strict=False)
    ]
    traces, trace_source = traces_of(part, list(dict.fromkeys(shown)), time_range, units)
    every = np.ones((problem.chains, problem.beads)) if radius is None else radius / np.max(radius)
    sizes = every[np.ix_(np.array(part.chains) - 1, part.beads - 1)]
    moving, controls = moving_beads(problem, part, images, now, colours, units, sizes)
    on_click(maps, part, images, trace_source)
    below = [traces, *forces(problem, part, readings, traces.x_range, units)]
    if found is not None and problem.system.holds(Fact.PULSE):
        bead_range = place_range if part.even else (float(part.beads[0]) - 1.0, float(part.beads[-1]) + 1.0)
        below += distances(problem, part, found, bead_range, units)
    if problem.whole:
        below.append(energy(part, traces.x_range, units))
    for plot in below:
        plot.styles = {"flex": f"1 1 {_NARROWEST}px"}
    moving.toolbar.logo = None
    return column(
        _side_by_side(maps),
        controls,
        moving,
        row(*below, styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width"),
        sizing_mode="stretch_width",
    )


def _side_by_side(maps: list[Any]) -> Any:
    """The maps of the chains in rows; a narrow page makes all of them narrower."""
    across = min(PLOTS_A_ROW, len(maps))
    found = gridplot(
        [maps[k : k + across] for k in range(0, len(maps), across)],
        toolbar_location="right",
        toolbar_options={"logo": None},
        sizing_mode="stretch_width",
    )
    found.cols = [f"calc((100% - {_BAR}px) / {across})"] * (across - 1) + ["1fr"]  # beside the last are the colours
    return found
