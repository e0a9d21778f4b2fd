"""Choice of the quantity on the maps and of the scale of their colours; the bar of colours and its unit follow."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from bokeh.layouts import row
from bokeh.models import ColorBar, CustomJS, LinearColorMapper, SaveTool, Toolbar

from granchain.parts import Floats, Problem, spacetime
from workflow.plugins.pages.downsample import Thinned
from workflow.plugins.pages.plots import MAPPED, choice, label_of, lists, map_palette, shown_quantities
from workflow.plugins.pages.save_data import tool_of_maps
from workflow.plugins.pages.units import Units, axis_of

ROOT = "root"
"""Scale at first: the square root of the size, with its sign."""

_SCALES = [(ROOT, "square root"), ("linear", "linear"), ("log", "logarithmic")]

_LEAST = 1e-3
"""Share of the largest value from which on the logarithmic scale is one; it is linear below."""

_POSITIVE = "GnBu"
"""Colours of quantities that are nowhere negative; light is 0, as on the maps of velocities."""

_SHOW = """
const {limit, signed, ticks} = quantities[quantity.value];
const forms = {
  linear: size => size,
  root: size => Math.sqrt(size),
  log: size => Math.log1p(size / least) / Math.log1p(1 / least),
};
const form = share => Math.sign(share) * forms[scale.value](Math.abs(share));
const palette = signed ? palettes.signed : palettes.positive, low = signed ? -1 : 0, colours = 8193;
const place = share => Math.round((form(share) - low) / (1 - low) * (palette.length - 1));
mapper.setv({
  palette: Array.from({length: colours}, (_, k) => palette[place(low + (1 - low) * k / (colours - 1))]),
  low: low * limit,
  high: limit,
});
for (const glyph of glyphs) glyph.image = {field: quantity.value};
for (const bar of bars) {
  const written = ticks[scale.value].map(tick => [form(tick / limit), String(+tick.toPrecision(4))]);
  bar.color_mapper.setv({palette, low, high: 1});
  bar.ticker.ticks = written.map(([at]) => at);
  bar.major_label_overrides = new Map(written);
  bar.title = labels[quantity.value];
}
save.filename = save.filename.replace(/map-[a-z]+$/, `map-${quantity.value}`);
"""


def map_choice(
    problem: Problem,
    part: Thinned,
    units: Units,
    maps: Iterable[Any],
    colours: LinearColorMapper,
    toolbar: Toolbar,
) -> Any:
    """Choices of a quantity and of a scale for maps that show velocities at first.

    Args:
        problem: what was run.
        part: of its frames, in units of the page.
        units: of the page.
        maps: of the chains.
        colours: of the maps.
        toolbar: of the maps.
    """
    names = shown_quantities(part)
    labels = {name: label_of(name, units) for name in names}
    options = [(name, MAPPED[name].words) for name in names]
    quantity = choice("quantity on the maps", names[0], options, "quantity")
    scale = choice("scale of colours", ROOT, _SCALES, "scale")
    plots = list(maps)
    arguments = {
        "quantity": quantity,
        "scale": scale,
        "labels": labels,
        "quantities": {name: _scaled(problem, part, name) for name in names},
        "palettes": {"signed": map_palette(), "positive": map_palette(_POSITIVE)},
        "mapper": colours,
        "glyphs": [plot.renderers[0].glyph for plot in plots],
        "bars": [bar for plot in plots for bar in plot.right if isinstance(bar, ColorBar)],
        "save": next(tool for tool in toolbar.tools if isinstance(tool, SaveTool)),
        "least": _LEAST,
    }
    show = CustomJS(args=arguments, code=_SHOW)
    for select in (quantity, scale):
        select.js_on_change("value", show)
    images = [plot.renderers[0].data_source for plot in plots]
    heads = {"time": axis_of("time", units).label.plain, **labels}
    toolbar.tools.append(tool_of_maps(f"{problem.name}-map-{names[0]}", images, lists(part), quantity, heads))
    return row(quantity, scale, sizing_mode="stretch_width", styles={"flex-wrap": "wrap"})


def _scaled(problem: Problem, part: Thinned, name: str) -> dict[str, Any]:
    """Largest value, whether there are negative ones, and ticks of each scale, of a quantity on the maps."""
    values = getattr(part, name)
    colours = spacetime.RootScale.of(problem, part.beads, values)
    signed = name == "velocity" or float(np.nanmin(values)) < -colours.least
    return {
        "limit": colours.limit,
        "signed": signed,
        "ticks": {scale: _ticks(scale, colours.limit, signed=signed) for scale, _ in _SCALES},
    }


def _ticks(scale: str, limit: float, *, signed: bool) -> list[float]:
    """Round numbers up to a limit, about evenly spaced in a scale; also negative ones where there are such."""
    if scale == ROOT:
        positive = [tick for tick in spacetime.RootScale(limit).ticks if tick > 0.0]
    elif scale == "log":
        top = math.floor(math.log10(limit))
        positive = [10.0 ** (top - decade) for decade in range(round(-math.log10(_LEAST)))]
    else:
        step = max(digit for digit in _digits(limit) if 3.0 * digit <= limit)
        positive = (step * np.arange(1, math.floor(limit / step) + 1)).tolist()
    return [*(-tick for tick in positive if signed), 0.0, *positive]


def _digits(limit: float) -> Floats:
    """Steps of 1, 2 and 5 times powers of ten near a limit."""
    decade = 10.0 ** math.floor(math.log10(limit))
    return np.array([0.1, 0.2, 0.5, 1.0, 2.0]) * decade
