"""The page of a run: its plots, and where they stand."""

from typing import Any

import numpy as np
from bokeh.layouts import column, gridplot
from bokeh.models import HoverTool, LinearColorMapper, Span
from bokeh.palettes import diverging_palette, interp_palette

from analysis.figures.spacetime import STILL, largest_afar, moving_part
from analysis.sharing.survey import Survey
from lammps_inputs import Problem, physics
from lammps_inputs.facts import Fact
from workflow.view.axes import graph, number, of_chain, put_legend_aside
from workflow.view.maps import PLOTS_A_ROW, image_source, maps_of, on_click, traces_of
from workflow.view.moving import moving_beads
from workflow.view.thin import Thinned, Units, axis_label, units_of


def distances(problem: Problem, part: Thinned, found: Survey, bead_range: Any, units: Units) -> list[Any]:
    """Peak velocity, lag and energy of the leading pulse along the chains."""
    waves, time, velocity = found.waves, units["time"], units["velocity"]
    if not len(waves):
        return []
    peaks = graph("peak velocity of the leading pulse", "bead", axis_label("velocity", velocity), bead_range)
    hit = physics.largest_excitation(problem.system)[0]
    lags = graph(f"arrival after that in chain {hit}", "bead", axis_label("time", time), bead_range)
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


def energy(part: Thinned, time_range: Any, units: Units) -> Any:
    """Energy of the beads of each chain that is shown, with their contacts and what holds them, over time."""
    heading = "energy of each chain, without coupling"
    plot = graph(heading, axis_label("time", units["time"]), axis_label("energy", units["energy"]), time_range)
    for place, chain in enumerate(part.chains):
        plot.line(part.time, part.energy[place], **of_chain(place, chain))
    put_legend_aside(plot)
    return plot


_BLUE_RED = diverging_palette(
    interp_palette(["#08306b", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7"], 128),
    interp_palette(["#67001f", "#b2182b", "#d6604d", "#f4a582", "#fddbc7", "#f7f7f7"], 128),
    n=255,
)

_BAR = 70
"""Width of the bar of colours."""


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
    images = [image_source(part, place) for place in range(len(part.chains))]
    now = Span(dimension="width", location=float(part.time[0]), line_color="#d55e00", line_width=1.5)
    largest = largest_afar(problem, part.beads, part.velocity)
    colours = LinearColorMapper(palette=_BLUE_RED, low=-largest, high=largest, nan_color="#999999")
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
    moving, controls = moving_beads(problem, part, images, now, colours, units)
    on_click(maps, part, images, trace_source)
    below = [traces]
    if found is not None and problem.system.holds(Fact.PULSE):
        bead_range = place_range if part.even else (float(part.beads[0]) - 1.0, float(part.beads[-1]) + 1.0)
        below += distances(problem, part, found, bead_range, units)
    if problem.whole:
        below.append(energy(part, traces.x_range, units))
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
