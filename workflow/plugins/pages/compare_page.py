"""The plots of a page that compares two runs: the difference of their velocities, and those of a bead in both."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.layouts import column, gridplot, row
from bokeh.models import ColorBar, ColumnDataSource, CustomJS, HoverTool, Range1d, Span

from granchain.parts import Problem, Trajectory, panels, spacetime
from granchain.parts import units as labels
from workflow.plugins.pages.downsample import MOST_NUMBERS, Thinned, thinned, units_of
from workflow.plugins.pages.plots import (
    LINE_WIDTH,
    add_legend,
    choice,
    ends,
    graph,
    lists,
    look,
    maps_of,
    number,
    root_colours,
)
from workflow.plugins.pages.units import Units, axis_of

Pair = tuple[Trajectory, Trajectory]

_OTHER_DASH = [6, 4]
"""Dashes of the line of run B, in pixels, on the solid line of run A."""

_NARROWEST = 480
"""Pixels of a plot of lines; two stand side by side where there is room."""

_CHOOSE = """
const chain_place = chains.length > 1 ? chains.indexOf(Number(chain.value)) : 0, i = beads.indexOf(Number(bead.value));
const columns = images[chain_place].data, data = {time: source.data.time};
for (const [name, column] of [["first", "first"], ["second", "second"], ["difference", "velocity"]]) {
  data[name] = Float32Array.from(time, (_, k) => columns[column][0][k * beads.length + i]);
}
source.data = data;
marks.forEach((mark, k) => { mark.visible = k == chain_place; mark.location = places[i]; });
for (const plot of plots)
  plot.title.text = plot.tags[0] + `bead ${beads[i]}` + (chains.length > 1 ? `, chain ${chains[chain_place]}` : "");
"""

_TAP = """
const distance = places.map(place => Math.abs(place - cb_obj.x));
bead.value = String(beads[distance.indexOf(Math.min(...distance))]);
if (chain) chain.value = String(number);
"""


@dataclass(frozen=True)
class ComparedRuns:
    """Frames of two runs at common times and beads, and their difference, A minus B.

    Attributes:
        first, second: runs A and B.
        difference: velocity of A minus that of B in ``velocity``; of omitted frames the largest in size.
    """

    first: Thinned
    second: Thinned
    difference: Thinned


def compared_frames(problem: Problem, pairs: Iterable[Pair], chains: list[int]) -> ComparedRuns:
    """What a page shows of two runs.

    Args:
        problem: beads and times that both recorded.
        pairs: blocks of A and B at these beads and times, from the start.
        chains: chains that are shown, counted from 0.
    """
    lines = [chain + line * problem.chains for line in range(3) for chain in chains]
    part = thinned(
        problem,
        (_side_by_side(problem, *pair) for pair in pairs),
        lines,
        most_numbers=3 * MOST_NUMBERS,
        deforms=False,
        energies=False,  # that of a difference means nothing
    )

    def of_lines(first: int) -> Thinned:
        """Part of the frames with as many lines as chains are shown, from a line on."""
        place = slice(first, first + len(chains))
        numbers = {
            name: getattr(part, name)[place] for name in ("displacement", "velocity", "overlap", "force", "energy")
        }
        return replace(part, chains=[chain + 1 for chain in chains], **numbers)

    return ComparedRuns(*(of_lines(line * len(chains)) for line in range(3)))


def _side_by_side(problem: Problem, first: Trajectory, second: Trajectory) -> Trajectory:
    """Frames with the chains of A, then those of B, then their differences A minus B, as lines."""
    rows = first.problem.rows.only(None if problem.rows.follow else problem.rows.numbers)
    x, v = (
        np.concatenate([values, other_values, values - other_values], axis=1)
        for values, other_values in (
            (first.displacement, second.displacement),
            (first.velocity, second.velocity),
        )
    )
    return Trajectory(replace(first.problem, rows=rows), first.time, x, v, first.first)


def layout(problem: Problem, runs: ComparedRuns, names: tuple[str, str], shown_bead: int) -> tuple[Any, CustomJS]:
    """The plots of a page.

    Returns:
        The plots, and what draws the velocities of the bead that is chosen, to be run when the page is ready.

    Args:
        problem: beads and times that both recorded.
        runs: their frames, dimensionless.
        names: names of A and B in legends.
        shown_bead: bead whose velocities are drawn at first.
    """
    units, difference_units = units_of(problem, runs.first), units_of(problem, runs.difference)
    limit = float(np.nanmax(np.abs(runs.difference.velocity), initial=0.0)) * difference_units["velocity"].worth
    scale = spacetime.RootScale(float(np.nanmax(np.abs(runs.first.velocity), initial=0.0)))
    first, second = (part.measured(units) for part in (runs.first, runs.second))
    difference_units |= {"time": units["time"]}
    difference = runs.difference.measured(difference_units)
    images = [_images(first, second, difference, place) for place in range(len(first.chains))]
    all_places = ends(first.places, first.spacing)
    place_range = Range1d(*scale.moving_part(runs.first.velocity, first.places, all_places), bounds=all_places)
    instants = ends(first.time, first.every)
    ranges = place_range, Range1d(*instants, bounds=instants)
    colours = root_colours(limit or 1.0)
    rows = maps_of(problem, difference, images, colours, difference_units, ranges)
    maps = [plot for line in rows for plot in line]
    for plot in maps:
        _of_differences(plot, units, difference_units)
    time_range = Range1d(*instants, bounds=instants)
    velocities = {"first": first, "second": second, "difference": difference}
    place = int(np.argmin(np.abs(first.beads - shown_bead)))
    columns = {name: part.velocity[0, :, place].astype(np.float32) for name, part in velocities.items()}
    source = ColumnDataSource({"time": first.time.astype(np.float32), **columns}, name="traces")
    plots = _traces(source, names, units, difference_units, time_range)
    choices, choose = _choices(first, maps, images, plots, source, int(first.beads[place]))
    grid = gridplot(rows, toolbar_location="above", toolbar_options={"logo": None}, sizing_mode="stretch_width")
    grid.name = "difference"
    for plot in plots:
        plot.styles = {"flex": f"1 1 {_NARROWEST}px"}
    traces = row(*plots, styles={"flex-wrap": "wrap"}, sizing_mode="stretch_width")
    return column(grid, choices, traces, sizing_mode="stretch_width"), choose


def _images(first: Thinned, second: Thinned, difference: Thinned, place: int) -> ColumnDataSource:
    """Difference of the velocities of a chain, those of both runs, and where the map stands."""
    (left, right), (start, end) = ends(first.places, first.spacing), ends(first.time, first.every)
    velocities = {"velocity": difference, "first": first, "second": second}
    arrays = {name: [part.velocity[place].astype(np.float32)] for name, part in velocities.items()}
    box = {"x": [left], "y": [start], "dw": [right - left], "dh": [end - start]}
    return ColumnDataSource(name=f"chain-{first.chains[place]}", data={**arrays, **box})


def _of_differences(plot: Any, units: Units, difference_units: Units) -> None:
    """Let the cursor and the bar of a map name differences, beside the velocities of both runs."""
    plot.center = [part for part in plot.center if not isinstance(part, Span)]
    (hover,) = plot.select({"type": HoverTool})
    hover.tooltips = [
        *hover.tooltips[:2],
        ("velocity in A", "@first{custom}"),
        ("velocity in B", "@second{custom}"),
        ("A minus B", "@velocity{custom}"),
    ]
    hover.formatters |= {f"@{name}": number(units["velocity"]) for name in ("first", "second")}
    for bar in plot.select({"type": ColorBar}):
        bar.title = _difference_axis(difference_units).label.plain
    plot.add_layout(Span(dimension="height", location=0.0, line_color="#888888", line_dash="dashed", visible=False))


def _difference_axis(difference_units: Units) -> panels.Axis:
    """Axis of differences of velocities."""
    return panels.Axis(labels.Label("velocity, A minus B", unit=difference_units["velocity"].symbol))


def _traces(
    source: ColumnDataSource, names: tuple[str, str], units: Units, difference_units: Units, time_range: Range1d
) -> list[Any]:
    """Plots of the velocity of a bead in both runs and of their difference."""
    time = axis_of("time", units)
    both = graph(" ", "velocities", time, axis_of("velocity", units), time_range)
    both.tags = ["velocity: "]
    lines = [
        both.line("time", "first", source=source, **{**look(0), "line_width": 1.5 * LINE_WIDTH}),
        both.line("time", "second", source=source, **{**look(1), "line_dash": _OTHER_DASH}),
    ]
    add_legend(both, [(f"{letter}: {name}", [line]) for letter, name, line in zip("AB", names, lines, strict=True)])
    apart = graph(" ", "velocity-difference", time, _difference_axis(difference_units), time_range)
    apart.tags = ["velocity, A minus B: "]
    apart.line("time", "difference", source=source, **look(2) | {"line_dash": "solid"})
    for plot in (both, apart):
        plot.center = [part for part in plot.center if not isinstance(part, Span)]
    return [both, apart]


def _choices(
    part: Thinned,
    maps: list[Any],
    images: list[ColumnDataSource],
    plots: list[Any],
    source: ColumnDataSource,
    shown_bead: int,
) -> tuple[Any, CustomJS]:
    """Choices of the bead and, of several chains, of the chain, which a click in a map makes, too; and what they do."""
    bead = choice("bead (or click a map)", str(shown_bead), list(map(str, part.beads)), "bead")
    several = len(part.chains) > 1
    chain = choice("chain", str(part.chains[0]), list(map(str, part.chains)), "chain") if several else None
    marks = [line for plot in maps for line in plot.center if isinstance(line, Span)]
    arguments = {**lists(part), "bead": bead, "chain": chain, "images": images, "marks": marks}
    arguments |= {"plots": plots, "source": source}
    choose = CustomJS(args=arguments, code=_CHOOSE)
    chosen = [bead, *([chain] if chain is not None else [])]
    for chooser in chosen:
        chooser.js_on_change("value", choose)
    for plot, number_of_chain in zip(maps, part.chains, strict=True):
        tapped = {**lists(part), "bead": bead, "chain": chain, "number": number_of_chain}
        plot.js_on_event(Tap, CustomJS(args=tapped, code=_TAP))
    return row(*chosen, sizing_mode="stretch_width"), choose
