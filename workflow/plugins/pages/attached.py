"""Walls and other atoms, such as resonators, among the moving beads."""

from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, CustomJS, Slider

from granchain.parts import Problem
from workflow.plugins.pages.downsample import Thinned

_THICK = 0.22
"""Thickness of a wall in distances between neighbouring beads."""

_MOVE = """
const n = places.length, k = Math.min(frames - 1, Math.round((slider.value - slider.start) / slider.step));
const widest = Math.min(most_pixels, 0.95 * spacing * plot.inner_width / most_places), x = [], y = [], r = [];
lines.data.displacement.forEach((displacement, line) => {
  for (let i = 0; i < n; i++) {
    const moved = displacement[k * n + i];
    if (isNaN(moved)) continue;
    x.push(places[i] + exaggerated * moved); y.push(-rows[line]); r.push(0.45 * widest);
  }
});
dots.data = {x, y, r};
"""


def draw_walls(plot: Any, problem: Problem, part: Thinned) -> bool:
    """Draw the walls beside the first and last beads of the chains, where these are shown; whether there are any."""
    ends = {-1: (1, part.places[0] - 0.5 * part.spacing), 1: (problem.beads, part.places[-1] + 0.5 * part.spacing)}
    centres = []
    for side in sorted({int(wall.side) for wall in problem.system.walls}):
        bead, face = ends[side]
        if bead in (int(part.beads[0]), int(part.beads[-1])):
            centres.append(float(face) + 0.5 * side * _THICK * part.spacing)
    chains = len(part.chains)
    if centres:
        plot.rect(
            centres,
            0.5 * (1 - chains),
            width=_THICK * part.spacing,
            height=chains - 0.1,
            name="walls",
            fill_color="#b0b0b0",
            line_color="#777777",
            hatch_pattern="right_diagonal_line",
            hatch_color="#555555",
        )
    return bool(centres)


def draw_others(
    plot: Any, name: str, part: Thinned, slider: Slider, exaggerated: float, sight: tuple[float, float]
) -> bool:
    """Draw a circle that moves with the time of a slider for each atom beside the beads; whether there are any.

    Args:
        plot: of the moving beads.
        name: what these atoms are called.
        part: of a run's frames, in units of the page.
        slider: of the time.
        exaggerated: distance on the axis for a displacement of one unit of the page.
        sight: distance on the axis that is seen at most, and pixels of the largest bead at most.
    """
    if not np.any(np.isfinite(part.others)):
        return False
    lines = ColumnDataSource({"displacement": [line.astype(np.float32) for line in part.others]})
    dots = ColumnDataSource(name=name, data={"x": [], "y": [], "r": []})
    plot.scatter("x", "y", size="r", source=dots, fill_color="#ffffff", line_color="#000000", line_width=1.5)
    most_places, most_pixels = sight
    places = part.places.tolist()
    arguments = {
        "plot": plot,
        "slider": slider,
        "lines": lines,
        "dots": dots,
        "rows": [part.chains.index(chain) for chain in part.chain_of_other],
        "places": places,
        "frames": len(part.time),
        "spacing": part.spacing,
        "exaggerated": exaggerated,
        "most_places": min(most_places, places[-1] - places[0] + 2 * part.spacing),
        "most_pixels": most_pixels,
    }
    move = CustomJS(args=arguments, code=_MOVE)
    slider.js_on_change("value", move)
    plot.js_on_change("inner_width", move)  # once, when the page is laid out
    return True
