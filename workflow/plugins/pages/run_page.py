"""The page of a run: its plots, and where they stand."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from bokeh.layouts import column, gridplot, row
from bokeh.models import CheckboxGroup, CustomJS, Div, Range1d

from granchain.parts import (
    Fact,
    Floats,
    Integers,
    Problem,
    Survey,
    leading_waves,
    long_waves,
    panels,
    physics,
    spacetime,
)
from workflow.plugins.pages.downsample import Thinned, units_of
from workflow.plugins.pages.map_choice import map_choice
from workflow.plugins.pages.measured import curves_plot, plots_of
from workflow.plugins.pages.moving import moving_beads
from workflow.plugins.pages.plots import NOW, chain_name, ends, image_source, maps_of, root_colours
from workflow.plugins.pages.save_data import add_tool_of_curves
from workflow.plugins.pages.selection import selection
from workflow.plugins.pages.theory import along, draw_lines, lines_of, peaks_of
from workflow.plugins.pages.traces import TracePlot
from workflow.plugins.pages.units import Units, axis_of

# --- graphs over beads ------------------------------------------------------------------------------------------------


_DOTTED = {"name": "theory", "line_dash": "dotted", "line_width": 2}

_THEORY = [{**_DOTTED, "line_color": colour} for colour in ("#888888", "#00a651")]
"""Looks of lines of theory."""


Lines = list[tuple[Integers | Floats, Floats]]
"""Beads and values of each chain, both [point]."""


def distances(problem: Problem, part: Thinned, survey: Survey, bead_range: Range1d, units: Units) -> list[Any]:
    """Peak velocity and lag of the leading pulse along the chains, and impulses where chains are compared by them."""
    waves, shared, velocity = survey.waves, survey.shared, units["velocity"]
    if not len(waves):
        return []
    kicked = physics.largest_excitation(problem.system)[0]
    of_chain = {chain: waves.of_chain(chain) for chain in part.chains}
    peaks: Lines = [_pulse_by_pulse(passed, passed.peak_velocity * velocity.worth) for passed in of_chain.values()]
    theory = {name: (bead, value * velocity.worth) for name, (bead, value) in peaks_of(problem, survey).items()}
    kinds = [("peak velocity of the leading pulse", "peaks", "velocity", peaks)]
    if sum(len(passed) > 0 for passed in of_chain.values()) > 1:
        lags: Lines = [_lag(passed, waves.of_chain(kicked), units["time"].worth) for passed in of_chain.values()]
        kinds.append((f"arrival after that in {chain_name(kicked)}", "arrivals", "time", lags))
    if shared.of_impulses:
        bead = along(survey, shared.bead)
        impulses: Lines = [(bead, shared.amplitude[:, chain - 1] * velocity.worth) for chain in part.chains]
        kinds.append(("impulse of the first contact, over the mass", "impulses", "velocity", impulses))
    graphs = []
    for title, name, quantity, values in kinds:
        curves = []
        for place, (chain, (beads, value)) in enumerate(zip(part.chains, values, strict=True)):
            missing = panels.Missing(np.setdiff1d(problem.rows.numbers, beads), long_waves.period_of(problem.system))
            curves.append(panels.Curve(chain_name(chain), *panels.broken(beads, value, missing), place))
        if name == "peaks":
            curves += [panels.Curve(line, *points) for line, points in theory.items()]
        panel = panels.Panel(panels.BEAD, axis_of(quantity, units), tuple(curve for curve in curves if len(curve.x)))
        looks = dict(zip(theory, _THEORY, strict=False))
        graphs.append(curves_plot(title, name, [panel], bead_range, looks=looks))
    return graphs


def _pulse_by_pulse(waves: leading_waves.Waves, values: Floats) -> tuple[Floats, Floats]:
    """Beads and values of a chain's leading waves, with NaN half a bead behind the end of each pulse but the last."""
    at = waves.ends + 1
    return np.insert(waves.bead.astype(np.float64), at, waves.bead[at - 1] + 0.5), np.insert(values, at, np.nan)


def _lag(waves: leading_waves.Waves, reference: leading_waves.Waves, worth: float) -> tuple[Integers, Floats]:
    """Beads that two chains' waves passed, and the time from one to the other."""
    both, mine, theirs = np.intersect1d(waves.bead, reference.bead, return_indices=True)
    return both, (waves.arrival[mine] - reference.arrival[theirs]) * worth


# --- graphs over time -------------------------------------------------------------------------------------------------

_LEAST_SPAN = 0.02
"""Least range of an axis of energy, over the largest energy; less would show the error of the run."""


def energy(part: Thinned, time_range: Range1d, units: Units) -> Any:
    """Energy of the beads of each chain that is shown, with their contacts and what holds them, over time."""
    curves = panels.curves_of([chain - 1 for chain in part.chains], part.time, part.energy.T)
    panel = panels.Panel(axis_of("time", units), axis_of("energy", units), curves)
    plot = curves_plot("energy of each chain, without coupling", "energy", [panel], time_range)
    plot.y_range.min_interval = _LEAST_SPAN * float(np.max(part.energy))
    return plot


_MOST_INSTANTS = 4000
"""Instants of a force over time that are drawn at most."""


def forces(problem: Problem, part: Thinned, measurement: Any, time_range: Range1d, units: Units) -> list[Any]:
    """Forces that gauges read, a line for each and each chain that is shown, and those that push and drive beads.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        measurement: the measurement ``forces``; None where there are no gauges.
        time_range: of the axis.
        units: of the page.
    """
    graphs, time = [], axis_of("time", units)
    if measurement is not None:
        shown = [row[0] for row in measurement.sheet().rows]
        stride = slice(None, None, -(-len(shown[0].curves[0].x) // _MOST_INSTANTS))
        for place, panel in enumerate(shown):
            curves = tuple(replace(curve, x=curve.x[stride], y=curve.y[stride]) for curve in panel.curves)
            shown[place] = replace(panel, curves=curves)
        title = f"{shown[0].y.label.words} at gauges"
        graphs.append(curves_plot(title, "forces", shown, time_range, x=time))
    if loads := problem.system.loads:
        force, instants = axis_of("force", units), part.time / time.worth
        shown = []
        for load in loads:
            values = np.array([[load.force(t)] for t in instants]) * force.worth
            curves = panels.curves_of([load.chain - 1], part.time, values)
            shown.append(panels.Panel(time, force, curves, f"bead {load.bead}"))
        graphs.append(curves_plot("external force on beads", "external-forces", shown, time_range))
    return graphs


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
    further = plots_of(problem, measured, time_range, units)
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
    graphs = forces(problem, part, measurements.get("forces"), time_range, units)
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
