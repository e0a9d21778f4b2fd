"""The leading pulse along the chains, and the chains' energy over time."""

from typing import Any

import numpy as np
from bokeh.models import HoverTool

from analysis.sharing.survey import Survey
from lammps_inputs import Problem, physics
from workflow.view.axes import graph, number, of_chain, put_legend_aside
from workflow.view.thin import Thinned
from workflow.view.units import Units, axis_label


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
