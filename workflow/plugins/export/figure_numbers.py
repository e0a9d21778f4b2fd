"""The numbers behind a drawn figure: a table of each of its panels, from what matplotlib has drawn."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, PathCollection, QuadMesh
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from granchain.parts import Floats

SERIES = "series"
"""Heading of the column that names a curve as its legend does."""

Row = tuple[str, Floats, Floats, Floats]
"""Name, x, y and value of each point of a curve; NaN is the value of what has no colour."""


def panels(figure: Figure) -> list[dict[str, Any]]:
    """Numbers of each panel of a figure that shows any, in order: heading -> column, [point].

    The columns are the name of the curve or image, x and y under the labels of their axes and, of points that a colour
    shows a value of, that value under the label of the bar of colours.

    Args:
        figure: what is drawn.
    """
    return [table for axis in figure.axes if axis.get_label() != "<colorbar>" and (table := _panel(axis))]


def captions(figure: Figure) -> list[str]:
    """What each panel of `panels` shows: y over x, the value that colours show, its title, and the figure's.

    Args:
        figure: what is drawn.
    """
    return [
        _caption(axis, figure.get_suptitle())
        for axis in figure.axes
        if axis.get_label() != "<colorbar>" and _panel(axis)
    ]


def _caption(axis: Axes, title: str) -> str:
    along, upwards, value = _heading(axis, "x"), _heading(axis, "y"), _colours(axis)
    shown = f"{value} over {along} and {upwards}" if value else f"{upwards} over {along}"
    titles = (_plain(axis.get_title(loc=side)) for side in ("left", "center", "right"))
    return "; ".join(filter(None, [shown, *titles, _plain(title)]))


def _panel(axis: Axes) -> dict[str, Any]:
    """Table of one panel; empty where it shows no number."""
    parts = [row for row in _parts(axis) if len(row[1])]
    if not parts:
        return {}
    x, y, value = (np.concatenate([row[place] for row in parts]) for place in (1, 2, 3))
    names = [name for name, along, *_ in parts for _ in range(len(along))]
    columns: dict[str, Any] = {SERIES: names, _heading(axis, "x") or "x": x, _heading(axis, "y") or "y": y}
    if len(columns) < 3:  # both axes show the same
        columns = {SERIES: names, "x": x, "y": y}
    if np.isfinite(value).any():
        columns[_colours(axis) or "value"] = value
    return columns


def _parts(axis: Axes) -> Iterator[Row]:
    """Everything that a panel shows in units of its axes."""
    for place, line in enumerate(axis.lines, 1):
        if line.get_transform() == axis.transData:
            x, y = (np.asarray(values, dtype=np.float64) for values in line.get_data())
            yield _name(line, f"line {place}"), x, y, np.full(len(x), np.nan)
    for place, bars in enumerate((part for part in axis.containers if isinstance(part, BarContainer)), 1):
        x = np.array([patch.get_x() + 0.5 * patch.get_width() for patch in bars.patches])
        y = np.array([patch.get_y() + patch.get_height() for patch in bars.patches])
        yield _name(bars, f"bars {place}"), x, y, np.full(len(x), np.nan)
    for place, collection in enumerate(axis.collections, 1):
        yield from _of_collection(collection, place)
    for place, image in enumerate(axis.images, 1):
        yield _of_image(image, place)


def _of_collection(collection: Collection, place: int) -> Iterator[Row]:
    """Points, segments, areas and meshes of colours."""
    values = collection.get_array()
    if isinstance(collection, QuadMesh):
        corners = np.asarray(collection.get_coordinates(), dtype=np.float64)
        centres = 0.25 * (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:])
        shown = np.ma.filled(np.ma.asarray(values, dtype=np.float64), np.nan).ravel()
        yield _name(collection, f"mesh {place}"), centres[..., 0].ravel(), centres[..., 1].ravel(), shown
    elif isinstance(collection, PathCollection):
        points = np.ma.filled(np.ma.asarray(collection.get_offsets(), dtype=np.float64), np.nan).reshape(-1, 2)
        shown = np.full(len(points), np.nan) if values is None else np.ma.filled(values, np.nan).astype(np.float64)
        yield _name(collection, f"points {place}"), points[:, 0], points[:, 1], shown
    else:
        kind = "segments" if isinstance(collection, LineCollection) else "area"
        for number, path in enumerate(collection.get_paths(), 1):
            vertices = np.asarray(path.vertices, dtype=np.float64)
            name = _name(collection, f"{kind} {place}.{number}")
            yield name, vertices[:, 0], vertices[:, 1], np.full(len(vertices), np.nan)


def _of_image(image: AxesImage, place: int) -> Row:
    """Centres and values of the cells of an image, row after row from its first."""
    values = np.ma.filled(np.ma.asarray(image.get_array(), dtype=np.float64), np.nan)
    rows, columns = values.shape[:2]
    left, right, bottom, top = image.get_extent()
    if image.origin == "upper":
        bottom, top = top, bottom
    x = left + (right - left) * (np.arange(columns) + 0.5) / columns
    y = bottom + (top - bottom) * (np.arange(rows) + 0.5) / rows
    along, upwards = np.meshgrid(x, y)
    return _name(image, f"image {place}"), along.ravel(), upwards.ravel(), values.reshape(rows * columns, -1)[:, 0]


def _name(artist: Any, otherwise: str) -> str:
    """Label in the legend, or another name where there is none."""
    label = str(artist.get_label())
    return otherwise if not label or label.startswith("_") else _plain(label)


def _heading(axis: Axes, direction: str) -> str:
    """Label of an axis, or of one that shares it."""
    shared = getattr(axis, f"get_shared_{direction}_axes")().get_siblings(axis)
    labels = (getattr(other, f"get_{direction}label")() for other in (axis, *shared))
    return _plain(next(filter(None, labels), ""))


def _colours(axis: Axes) -> str:
    """Label of the bar of colours of a panel."""
    bars = (artist.colorbar for artist in (*axis.images, *axis.collections) if artist.colorbar is not None)
    labels = [bar.ax.get_ylabel() or bar.ax.get_xlabel() for bar in bars]
    labels += [other.get_ylabel() for other in axis.figure.axes if other.get_label() == "<colorbar>"]
    return _plain(next(filter(None, labels), ""))


def _plain(text: str) -> str:
    """A label without the marks of TeX, in one line: ``time t (ms)`` of ``time $t$ (ms)``."""
    words = re.sub(r"\\mathrm\{([^}]*)\}", r"\1", text.replace("\\,", " "))
    return " ".join(re.sub(r"[$\\{}]", "", words).split())
