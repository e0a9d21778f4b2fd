"""What a figure of matplotlib shows as a table of text, and texts of it that are cut or cover each other.

A table has a paragraph for each panel: titles, axes with their ends, and a line for each curve, area or image with the
number of its points, few points as they are, of many the first, the last, the lowest and the highest.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PathCollection, PolyCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter

from workflow.formats import written_as

at_both_widths = pytest.mark.parametrize("width", [None, 3.4], ids=["usual", "narrow"])
"""Widths of figures: each its usual one, and that of one column of a journal, in inches."""


def assert_shown(
    name: str, draw: Callable[[], Figure], width: float | None, golden: Callable[[str, str], None]
) -> None:
    """Texts of a figure can be read; with its usual width it is as its table says, with another it has no title."""
    with written_as(("png",), width):
        figure = draw()
    if width is None:
        golden(name, table(figure))
    else:
        assert (figure.get_figwidth(), figure.get_suptitle()) == (width, "")
    assert unreadable(figure) == []  # after the table: the layout changes ends of axes


FEW = 6
"""Points of a line that are all written."""


def number(value: float, size: float = 0.0) -> str:
    """Six digits; 0 for what is nothing beside numbers of a size."""
    return "-" if math.isnan(value) else f"{0.0 if abs(value) < 1e-9 * size else value:.6g}"


def points(x: np.ndarray, y: np.ndarray) -> str:
    """Points of a line, all or some."""
    x, y = (np.ma.filled(np.ma.asarray(values, dtype=float), np.nan).ravel() for values in (x, y))
    sizes = [float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0)) for values in (x, y)]
    full = np.flatnonzero(np.isfinite(y))

    def at(place: int) -> str:
        return f"({number(x[place], sizes[0])}, {number(y[place], sizes[1])})"

    if len(x) <= FEW or len(full) == 0:
        return f"{len(x)} points: {' '.join(map(at, range(min(len(x), FEW))))}"
    rounded = np.round(y[full], 12 - math.ceil(math.log10(sizes[1] or 1.0)))  # of equal ones the first
    low, high = full[np.argmin(rounded)], full[np.argmax(rounded)]
    gaps = f", {len(y) - len(full)} without number" if len(full) < len(y) else ""
    return f"{len(x)} points{gaps}: {at(full[0])} to {at(full[-1])}, lowest {at(low)}, highest {at(high)}"


def _look(line: Line2D) -> str:
    dash = line._unscaled_dash_pattern[1]
    words = [to_hex(line.get_color()), line.get_linestyle() if dash is None else f"dashes {tuple(map(float, dash))}"]
    if line.get_marker() not in ("None", "", None):
        words.append(line.get_marker())
        words += ["hollow"] * (to_hex(line.get_markerfacecolor()) == "#ffffff")
    return " ".join([*words, *["outlined"] * bool(line.get_path_effects())])


def grid(values: np.ndarray, x: np.ndarray, y: np.ndarray) -> str:
    """The shape of an image whose pixels have these edges, and where it is lowest and highest."""
    filled = np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)
    size = float(np.nanmax(np.abs(filled), initial=0.0))
    words = f"{filled.shape[0]} rows, {filled.shape[1]} columns, x {number(x[0])} to {number(x[-1])}, "
    words += f"y {number(y[0])} to {number(y[-1])}, {np.count_nonzero(np.isnan(filled))} without number"
    for name, place in (("lowest", np.nanargmin), ("highest", np.nanargmax)) if np.isfinite(filled).any() else ():
        row, column = np.unravel_index(int(place(np.round(filled, 12))), filled.shape)
        middle = [number(0.5 * (edges[k] + edges[k + 1])) for edges, k in ((x, column), (y, row))]
        words += f", {name} {number(filled[row, column], size)} at ({', '.join(middle)})"
    return words


def _drawn(axis: Axes) -> Iterator[str]:
    for image in axis.get_images():
        values = image.get_array()
        left, right, bottom, top = image.get_extent()
        low, high = image.get_clim()
        edges = np.linspace(left, right, values.shape[1] + 1), np.linspace(bottom, top, values.shape[0] + 1)
        yield f"image: {grid(values, *edges)}; colours {image.get_cmap().name} {number(low)} to {number(high)}"
    for part in axis.collections:
        name = "" if part.get_label().startswith("_") else f' "{part.get_label()}"'
        if isinstance(part, QuadMesh):
            corners = part.get_coordinates()
            yield f"mesh: {grid(part.get_array(), corners[0, :, 0], corners[:, 0, 1])}"
        elif isinstance(part, PathCollection):
            yield f"marks{name}: {points(*np.asarray(part.get_offsets()).T)}"
        elif isinstance(part, PolyCollection) and part.get_paths():
            box = part.get_paths()[0].get_extents()
            hatch = f" hatch {part.get_hatch()}" if part.get_hatch() else ""
            yield f"area{name}{hatch}: x {number(box.x0)} to {number(box.x1)}, y {number(box.y0)} to {number(box.y1)}"
        elif isinstance(part, LineCollection) and len(ends := part.get_segments()):
            yield f"bars: {len(ends)}, " + " to ".join(f"({number(x)}, {number(y)})" for x, y in ends[0])
    for patch in axis.patches:
        box = patch.get_path().get_extents(patch.get_patch_transform())
        yield f"patch: x {number(box.x0)} to {number(box.x1)}, y {number(box.y0)} to {number(box.y1)}"
    for line in axis.get_lines():
        name = "" if line.get_label().startswith("_") else f' "{line.get_label()}"'
        yield f"line{name} {_look(line)}: {points(*line.get_data())}"
    yield from (f"note: {text.get_text()}" for text in axis.texts)


def _axis(axis: Axes, name: str) -> str:
    setting, ends = getattr(axis, f"{name}axis"), getattr(axis, f"get_{name}lim")()
    size = max(map(abs, ends))
    words = f"{name}: {setting.get_label_text() or '(no label)'}, {number(ends[0], size)} to {number(ends[1], size)}"
    words += f", {setting.get_scale()}" * (setting.get_scale() != "linear")
    if isinstance(setting.get_major_formatter(), FixedFormatter):
        words += f", ticks {' '.join(tick.get_text() for tick in setting.get_majorticklabels())}"
    return words


def table(figure: Figure) -> str:
    """What a figure shows."""
    shared = [figure.get_suptitle(), figure.get_supxlabel(), figure.get_supylabel()]
    lines = [f"{name}: {text}" for name, text in zip(("title", "x of all", "y of all"), shared, strict=True) if text]
    for axis in figure.axes:
        if axis.get_label() == "<colorbar>":
            lines += ["", f"bar of colours: {axis.get_ylabel()}"]
            continue
        titles = [axis.get_title(loc=place) for place in ("left", "center", "right")]
        lines += ["", "panel: " + " | ".join(title for title in titles if title)]
        lines += [_axis(axis, name) for name in "xy"]
        lines += _drawn(axis)
    legends = [*figure.legends, *(axis.get_legend() for axis in figure.axes)]
    entries = [text.get_text() for legend in legends if legend is not None for text in legend.get_texts()]
    return "\n".join([*(line.replace("\n", " / ") for line in lines), "", f"legend: {', '.join(entries)}"])


SLACK = 1.0
"""Pixels by which texts may touch."""


def _texts(figure: Figure) -> list[tuple[str, Any]]:
    """Texts that are seen, with their boxes in pixels."""
    hidden: set[Artist] = set()
    for axis in figure.axes:
        for setting in (axis.xaxis, axis.yaxis):
            ticks = [*setting.get_major_ticks(), *setting.get_minor_ticks()]
            seen = set(setting._update_ticks())
            hidden |= {label for tick in ticks if tick not in seen for label in (tick.label1, tick.label2)}
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text() and text not in hidden]
    renderer = figure.canvas.get_renderer()
    return [(text.get_text(), text.get_window_extent(renderer)) for text in shown]


def unreadable(figure: Figure) -> list[str]:
    """Texts that end outside a figure or cover each other, panels that have vanished, and legends on panels."""
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    texts, ends = _texts(figure), figure.bbox
    wrong = [
        f"cut: {words}"
        for words, box in texts
        if min(box.x0, box.y0) < -SLACK or box.x1 > ends.x1 + SLACK or box.y1 > ends.y1 + SLACK
    ]
    for (words, one), (others, other) in itertools.combinations(texts, 2):
        if _overlap(one, other):
            wrong.append(f"covered: {words} and {others}")
    for axis in figure.axes:
        inside = axis.get_window_extent()
        title = axis.get_title(loc="left")
        wrong += [f"vanished: {title}"] * bool(min(inside.width, inside.height) < 5.0)
        wrong += [f"legend on {title}" for one in figure.legends if _overlap(one.get_window_extent(), inside)]
    return wrong


def _overlap(one: Any, other: Any) -> bool:
    across, along = (min(one.x1, other.x1) - max(one.x0, other.x0), min(one.y1, other.y1) - max(one.y0, other.y0))
    return bool(across > SLACK and along > SLACK)
