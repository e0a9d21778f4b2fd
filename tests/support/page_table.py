"""What a page of Bokeh shows as a table of text: plots with their axes, glyphs, marks and bars, and choices."""

import html
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from bokeh.models import ColorBar, CustomJS, DataTable, Div, GlyphRenderer, GridPlot, HoverTool, Legend, Span, Title
from bokeh.models.widgets import InputWidget
from bokeh.models.widgets.buttons import AbstractButton
from bokeh.models.widgets.groups import AbstractGroup
from bokeh.plotting import figure
from figure_table import grid as pixels
from figure_table import number, points

SEEN = ("springs", "radius")
"""Arguments of callbacks that say what is drawn."""


def _words(text: str) -> str:
    """Text of a part of a page, without its markup."""
    return " ".join(html.unescape(re.sub(r"<style.*?</style>|<[^>]+>", " ", text, flags=re.S)).split())


def _values(renderer: Any, name: str) -> Any:
    field = getattr(renderer.glyph, name, None)
    field = getattr(field, "field", field)
    return renderer.data_source.data.get(field) if isinstance(field, str) else None


def _is_seen(renderer: Any) -> bool:
    """Whether it has numbers, as far as it has any places."""
    y = _values(renderer, "y")
    return y is None or (len(y) > 0 and not all(one != one for one in y))


def _glyph(renderer: Any, label: str) -> str:
    glyph, data = renderer.glyph, renderer.data_source.data
    words = f"{type(glyph).__name__.lower()} {renderer.name or ''}".rstrip() + (f' "{label}"' if label else "")
    if type(glyph).__name__ == "Image":
        values = np.asarray(_values(renderer, "image")[0], dtype=float)
        sides = [(data[side][0], data[side][0] + data[f"d{'wh'[side == 'y']}"][0]) for side in "xy"]
        edges = [np.linspace(*ends, count + 1) for ends, count in zip(sides, values.shape[::-1], strict=True)]
        return f"{words}: {pixels(values, *edges)}"
    dash, marker = getattr(glyph, "line_dash", None), getattr(glyph, "marker", None)
    words += f" {glyph.line_color}" if isinstance(getattr(glyph, "line_color", None), str) else ""
    words += f" dashes {dash}" if dash else ""
    words += f" {marker}" if isinstance(marker, str) else ""
    x, y = _values(renderer, "x"), _values(renderer, "y")
    if x is None or y is None or len(x) == 0 or not all(isinstance(one, (int, float, np.number)) for one in [*x, *y]):
        return words
    return f"{words}: {points(np.array(x, dtype=float), np.array(y, dtype=float))}"


def _plot(plot: Any) -> Iterator[str]:
    yield f"plot {plot.name or ''}: {plot.title.text if isinstance(plot.title, Title) else plot.title or ''}"
    for side, axis, ends in (("x", plot.xaxis[0], plot.x_range), ("y", plot.yaxis[0], plot.y_range)):
        bounds = getattr(ends, "bounds", None)
        limits = f", within {' and '.join(map(number, bounds))}" if isinstance(bounds, (tuple, list)) else ""
        yield f"{side}: {axis.axis_label or '(no label)'}{limits}" + ", whole" * (
            getattr(axis.ticker, "min_interval", 0) == 1
        )
    legends = [part for part in (*plot.center, *plot.below, *plot.above, *plot.right) if isinstance(part, Legend)]
    labels = {
        renderer.id: getattr(item.label, "value", "")
        for one in legends
        for item in one.items
        for renderer in item.renderers
    }
    for one in plot.renderers:
        if isinstance(one, GlyphRenderer) and _is_seen(one):
            yield _glyph(one, labels.get(one.id, ""))
    for span in (part for part in plot.center if isinstance(part, Span)):
        yield f"mark {span.name or ''} {'across' if span.dimension == 'width' else 'upright'}"
    for bar in (part for part in (*plot.right, *plot.left, *plot.below, *plot.above) if isinstance(part, ColorBar)):
        mapper = bar.color_mapper
        ends = getattr(mapper, "factors", None) or [number(end) for end in (mapper.low, mapper.high) if end is not None]
        yield f"bar of colours: {bar.title}, {' to '.join(ends)}" + ", hidden" * (not bar.visible)
    for tool in plot.tools:
        if isinstance(tool, HoverTool) and isinstance(tool.tooltips, list):
            yield "cursor: " + ", ".join(
                f"{name}{(tool.formatters.get(value.removesuffix('{custom}')) or CustomJS()).args.get('unit', '')}"
                for name, value in tool.tooltips
            )


def _choice(part: Any) -> str:
    words = f"choice {part.name or ''}: {getattr(part, 'title', None) or getattr(part, 'label', None) or ''}"
    options = [
        one if isinstance(one, str) else one[1] for one in getattr(part, "options", None) or getattr(part, "labels", [])
    ]
    value = getattr(part, "value", getattr(part, "active", ""))
    ends = [number(getattr(part, end)) for end in ("start", "end", "step") if hasattr(part, end)]
    return (
        f"{words} = {value}"
        + (f"; {' | '.join(options[:12])}" if options else "")
        + (f"; {' '.join(ends)}" if ends else "")
    )


def page_table(root: Any) -> str:
    """What the layout of a page shows, in the order of the names of its parts."""
    plots = [list(_plot(plot)) for plot in root.select({"type": figure})]
    lines = [line for plot in sorted(plots) for line in ("", *plot)]
    choices = [one for kind in (InputWidget, AbstractGroup, AbstractButton) for one in root.select({"type": kind})]
    for grid in root.select({"type": GridPlot}):
        lines.append("")
        lines += [f"row {row}, column {column}: {plot.title.text}" for plot, row, column in grid.children]
    lines += ["", *sorted(map(_choice, choices))]
    for shown in root.select({"type": DataTable}):
        lines.append(f"columns: {' | '.join(column.title for column in shown.columns)}")
        columns = ("case", "x", "y", "low", "high", "solid", "link")
        rows = zip(*(shown.source.data[name] for name in columns), strict=True)
        lines += [" | ".join(one if isinstance(one, str) else number(one) for one in row) for row in rows]
    lines += sorted(f"text: {words}" for part in root.select({"type": Div}) if (words := _words(part.text)))
    arguments = {
        (name, str(code.args[name])) for code in root.select({"type": CustomJS}) for name in SEEN if name in code.args
    }
    return "\n".join([*lines, *(f"{name}: {value}" for name, value in sorted(arguments))])
