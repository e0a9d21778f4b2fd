"""Panels drawn with matplotlib: curves, images, their labels and one legend, placed alike in every figure.

Plug-ins take this module to draw panels: `draw` makes a figure of a sheet, `draw_panels` draws it into a figure.

Examples:
    >>> panel = panels.Panel(panels.BEAD, panels.BEAD, (panels.Curve("line", np.arange(3), np.arange(3.0)),))
    >>> [axis.get_xlabel() for axis in drawing.draw(panels.Sheet("two panels", ((panel,), (panel,)), 4.0)).axes]
    ['', 'bead']
"""

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure, FigureBase
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from analysis.figures.panels import Curve, Image, Panel, Sheet, alone
from analysis.figures.spacetime import RootScale
from analysis.figures.style import (
    CHAIN_COLOURS,
    CHAIN_DASHES,
    head,
    is_narrow,
    label_log_axis,
    legend_below,
    legend_beside,
    name_columns,
    new_figure,
    styled,
)

FEW_NUMBERS = 20
"""Points of a chain's line up to which each has a mark."""

_MISSING = "0.75"
"""Colour of pixels without a value."""


@styled
def draw(sheet: Sheet) -> Figure:
    """A figure of panels, with a title but where a width is asked for, and a legend below or beside the panels.

    Args:
        sheet: what it shows.

    Returns:
        The figure, of matplotlib.
    """
    figure = new_figure(sheet.height, sheet.width)
    axes = draw_panels(figure, sheet)
    head(figure, sheet.title)
    handles: dict[str, Any] = {}
    for axis in axes:
        for handle, name in zip(*axis.get_legend_handles_labels(), strict=True):
            handles.setdefault(name, handle)
    missing = [panel.image.missing for panel in sheet.panels if panel.image is not None and panel.image.missing]
    handles |= dict.fromkeys(missing, Patch(color=_MISSING))
    names = list(handles)
    if any(panel.layers for panel in sheet.panels):  # named as the layers lie
        legend_beside(figure, [handles[name] for name in names[::-1]], names[::-1], handleheight=1.4)
    elif missing or len(names) > 1:
        legend_below(figure, list(handles.values()), names)
    return figure


def draw_panels(figure: FigureBase, sheet: Sheet) -> list[Axes]:
    """Draw panels into a figure; a label that those of a column or a row share stands once.

    Args:
        figure: empty figure, or part of one.
        sheet: what it shows.

    Returns:
        The axes of the panels, row after row.
    """
    if is_narrow() and sheet.widths:  # which has no room for remarks either
        rows = [[panel and replace(panel, remark="") for panel in row[:2]] for row in sheet.rows]
        sheet = replace(sheet, rows=rows, widths=(1.25, 1.0)[: len(rows[0])])
    grid = figure.subplots(
        len(sheet.rows),
        len(sheet.rows[0]),
        sharex="col",
        sharey=sheet.same_y,
        squeeze=False,
        height_ratios=sheet.heights or None,
        width_ratios=sheet.widths or None,
    )
    axes, titles = [], iter(sheet.titles)
    lowest: dict[int, tuple[Axes, Panel]] = {}
    for (place, axis), panel in zip(np.ndenumerate(grid), itertools.chain(*sheet.rows), strict=True):
        if panel is None:
            axis.remove()
            continue
        _draw_panel(axis, panel)
        axis.set_title(next(titles), loc="left")
        lowest[place[1]] = axis, panel
        axes.append(axis)
    for axis, panel in lowest.values():
        axis.set_xlabel(panel.x.label.mathtext)
        axis.xaxis.set_tick_params(labelbottom=True)
    labels = [row[0].y.label.mathtext for row in sheet.rows if row[0] is not None]
    if len(labels) > 1 and len(set(labels)) == 1:
        figure.supylabel(labels[0], fontsize="medium")
    else:
        for axis, label in zip(grid[:, 0], labels, strict=True):
            axis.set_ylabel(label)
    for axis, panel in zip(axes, sheet.panels, strict=True):  # ends are known only when all is drawn
        if panel.x.beads:
            axis.xaxis.get_major_locator().set_params(integer=True)
            axis.set_xlim(left=max(0.0, axis.get_xlim()[0]))
        for setting, shown in ((axis.xaxis, panel.x), (axis.yaxis, panel.y)):
            if shown.log:
                label_log_axis(setting)
    _draw_bar(figure, axes, sheet)
    return axes


def _draw_panel(axis: Axes, panel: Panel) -> None:
    """Draw what a panel shows, between the ends of its axes."""
    low = np.zeros(())
    for layer in panel.layers:
        high = low + layer.y
        axis.fill_between(layer.x, low, high, edgecolor="white", linewidth=0.0, label=layer.name, **layer.look)
        low = high
    if panel.image is not None:
        _draw_image(axis, panel.image)
    for curve in panel.curves:
        _draw_curve(axis, curve, over_image=panel.image is not None)
    for marks in panel.marks:
        for number, place in enumerate(marks.places):
            (axis.axhline if marks.level else axis.axvline)(place, label=None if number else marks.name, **marks.look)
    axis.set_title(panel.remark, loc="right", fontsize="small", color="0.3")
    for name, shown in (("x", panel.x), ("y", panel.y)):
        if shown.ends != (None, None):
            axis.set(**{f"{name}lim": shown.ends})  # before the scale is logarithmic: all may be 0
        if shown.log:
            axis.set(**{f"{name}scale": "log"})
        if shown.ticks:
            axis.set(**{f"{name}ticks": list(shown.ticks), f"{name}ticklabels": list(shown.ticks.values())})


def _draw_curve(axis: Axes, curve: Curve, *, over_image: bool) -> None:
    """Draw a line; that of a chain in its look, with marks where it is short, and dots to which no line leads."""
    look, few = dict(curve.look), len(curve.x) <= FEW_NUMBERS
    if over_image:  # seen on all colours, and where a white line has gaps
        unbroken = {"dash_offset": 0.0, "dash_list": None}
        look["path_effects"] = [withStroke(linewidth=2.4, foreground="black", dashes=unbroken)]
    if curve.place is not None:
        look = {
            "color": CHAIN_COLOURS[curve.place % len(CHAIN_COLOURS)],
            "linestyle": CHAIN_DASHES[curve.place % len(CHAIN_DASHES)],
            "markersize": 4,
            "marker": "o" if few else None,
            **look,
        }
    (line,) = axis.plot(curve.x, curve.y, label=curve.name, **look)
    lonely = alone(curve.y)
    if curve.place is not None and not few and np.any(lonely):
        axis.plot(curve.x[lonely], curve.y[lonely], ".", color=line.get_color(), markersize=3)
    if curve.spread is not None:
        low, high = curve.y - curve.spread, curve.y + curve.spread
        axis.fill_between(curve.x, low, high, alpha=0.15, color=line.get_color(), linewidth=0)


def _draw_image(axis: Axes, image: Image) -> None:
    """Draw values as colours, grey where there is none."""
    axis.imshow(
        image.values,
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        extent=(*image.x, *image.y),
        cmap=RootScale.PALETTE if image.signed else "magma",
        norm=RootScale(image.colours[1]).norm if image.signed else Normalize(*image.colours),
        rasterized=True,
    )
    if image.missing:
        axis.set_facecolor(_MISSING)
    if image.columns is not None:
        name_columns(axis, image.columns)


def _draw_bar(figure: FigureBase, axes: list[Axes], sheet: Sheet) -> None:
    """Draw the bar of the colours of all images, if there is any."""
    images = [panel.image for panel in sheet.panels if panel.image is not None]
    if not images:
        return
    rows, columns, image = len(sheet.rows), len(sheet.rows[0]), images[0]
    beyond = any(float(np.nanmax(np.abs(each.values), initial=0.0)) > max(map(abs, image.colours)) for each in images)
    shape: dict[str, Any] = {"aspect": 20 * rows, "extendfrac": 0.05 / rows, "fraction": 0.15 / columns}
    ticks = RootScale(image.colours[1]).ticks if image.signed else None
    extend = "both" if beyond else "neither"
    bar = figure.colorbar(axes[0].images[0], ax=axes, ticks=ticks, extend=extend, **shape)
    bar.ax.yaxis.set_major_formatter("{x:.4g}")
    bar.ax.minorticks_off()
    bar.set_label(image.heading.replace("; ", ";\n") if is_narrow() else image.heading)
