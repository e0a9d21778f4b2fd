"""The page of a run: its plots, and where they stand."""

from typing import Any

import numpy as np
from bokeh.layouts import column, gridplot, row
from bokeh.models import HoverTool, Span

from analysis.figures.spacetime import STILL, largest_afar, moving_part
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from workflow.view.moving import moving_beads
from workflow.view.plots import (
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
        peak = {"bead": own.bead, "peak": own.peak_velocity * velocity.worth}
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


def layout(
    problem: Problem,
    part: Thinned,
    found: Survey | None,
    shown: list[int],
    *,
    radius: Floats | None = None,
) -> Any:
    """The plots of a page.

    Args:
        problem: what was run.
        part: of its frames, dimensionless.
        found: the waves in it; None where there are none.
        shown: beads whose velocity over time is drawn first.
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
    below = [traces]
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
