"""The numbers behind a figure: a table of each of its panels."""

import re
from typing import Any

import numpy as np

from granchain.parts import Floats, panels

SERIES = "series"
"""Heading of the column that names a curve as its legend does."""

BAND = "half of the height of the band"
"""Heading of the column of bands around curves."""


def columns_of(panel: panels.Panel) -> dict[str, Any]:
    """Numbers of a panel: heading -> column, [point]; empty where it shows none.

    The columns are the name of the curve or image, x and y under the labels of their axes and, of an image, its values
    under the label of the colours; of curves in a band also half of its height.

    Args:
        panel: what is shown.
    """
    parts: list[tuple[str, Any, Any, Any]] = []
    for curve in (*panel.curves, *panel.layers):
        spread = np.full(len(curve.x), np.nan) if curve.spread is None else curve.spread
        parts.append((_plain(curve.name), curve.x, curve.y, spread))
    if panel.image is not None:
        parts.append(("image 1", *_pixels(panel.image)))
    names = [name for name, x, *_ in parts for _ in x]
    if not names:
        return {}
    x, y, value = (np.concatenate([np.asarray(part[k], dtype=np.float64) for part in parts]) for k in (1, 2, 3))
    columns = {SERIES: names, _plain(panel.x.label.mathtext): x, _plain(panel.y.label.mathtext): y}
    if np.isfinite(value).any():
        columns[BAND if panel.image is None else _plain(panel.image.heading)] = value
    return columns


def _pixels(image: panels.Image) -> tuple[Floats, Floats, Floats]:
    """Middles of the pixels of an image, and their values, row after row, each [pixel]."""
    rows, columns = image.values.shape
    (left, right), (bottom, top) = image.x, image.y
    x = left + (right - left) * (np.arange(columns) + 0.5) / columns
    y = bottom + (top - bottom) * (np.arange(rows) + 0.5) / rows
    along, upwards = np.meshgrid(x, y)
    return along.ravel(), upwards.ravel(), image.values.ravel()


def caption(panel: panels.Panel, title: str, heading: str) -> str:
    """What a panel shows: y over x, the value that colours show, its title and remark, and the title of the figure.

    Args:
        panel: what is shown.
        title: of the panel, with its letter.
        heading: title of the figure.
    """
    along, upwards = _plain(panel.x.label.mathtext), _plain(panel.y.label.mathtext)
    shown = f"{upwards} over {along}"
    if panel.image is not None:
        shown = f"{_plain(panel.image.heading)} over {along} and {upwards}"
    return "; ".join(filter(None, [shown, *map(_plain, (title, panel.remark, heading))]))


def _plain(text: str) -> str:
    """A label without the marks of TeX, in one line: ``time t (ms)`` of ``time $t$ (ms)``."""
    words = re.sub(r"\\mathrm\{([^}]*)\}", r"\1", text.replace("\\,", " "))
    return " ".join(re.sub(r"[$\\{}]", "", words).split())
