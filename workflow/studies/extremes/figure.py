"""The report at a glance: one row an axis, cells coloured by how they ended, with the error in them."""

import textwrap
from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from analysis.figures.style import STYLE
from workflow.studies.extremes.measure import KINDS, Outcome

COLOURS = {"RIGHT": "#8fd0b5", "REPORTED": "#f5d76e", "REFUSED": "#d9d9d9", "STOPPED": "#a9c6e8", "WRONG": "#d7301f"}

_MEANING = {
    "RIGHT": "as right as asked",
    "REPORTED": "larger error, reported",
    "REFUSED": "refused with a reason",
    "STOPPED": "stopped with a reason",
    "WRONG": "silently wrong",
}

_CORNERS = "corners"
_CORNERS_A_ROW = 6
_WIDTH = 12.0


def extremes_figure(outcomes: Sequence[Outcome]) -> Figure:
    """A grid of cells: value on top, below it how it ended and the largest error of any velocity in units of V."""
    rows: list[tuple[str, list[Outcome]]] = []
    for axis in dict.fromkeys(outcome.axis for outcome in outcomes if outcome.axis != _CORNERS):
        rows.append((axis, [outcome for outcome in outcomes if outcome.axis == axis]))
    corners = [outcome for outcome in outcomes if outcome.axis == _CORNERS]
    for start in range(0, len(corners), _CORNERS_A_ROW):
        rows.append((_CORNERS if start == 0 else "", corners[start : start + _CORNERS_A_ROW]))
    columns = max((len(cells) for axis, cells in rows if axis not in (_CORNERS, "")), default=_CORNERS_A_ROW)
    with mpl.rc_context(STYLE):
        height = 0.62 * len(rows) + 0.5
        figure = Figure(figsize=(13.0, height))
        axes = figure.add_axes((0.1, 0.01, 0.89, 0.98 - 0.5 / height))
        for number, (axis, cells) in enumerate(rows):
            corner = axis in (_CORNERS, "")
            width = _WIDTH / (_CORNERS_A_ROW if corner else columns)
            axes.text(-0.1, number + 0.5, axis, ha="right", va="center", fontsize=10)
            for place, outcome in enumerate(cells):
                _draw_cell(axes, place * width, number, width, outcome, 26 if corner else 13)
        axes.set_xlim(0.0, _WIDTH)
        axes.set_ylim(len(rows), 0.0)
        axes.axis("off")
        found = [kind for kind in KINDS if any(outcome.kind == kind for outcome in outcomes)]
        handles = [Patch(color=COLOURS[kind], label=_label(kind, outcomes)) for kind in found]
        figure.legend(handles=handles, loc="upper center", ncols=len(handles), fontsize=9)
    return figure


def _label(kind: str, outcomes: Sequence[Outcome]) -> str:
    return f"{sum(outcome.kind == kind for outcome in outcomes)} {kind}: {_MEANING[kind]}"


def _draw_cell(axes: Axes, left: float, top: float, width: float, outcome: Outcome, letters: int) -> None:
    box = Rectangle((left + 0.03, top + 0.05), width - 0.06, 0.9, color=COLOURS[outcome.kind], linewidth=0.0)
    axes.add_patch(box)
    ink = "white" if outcome.kind == "WRONG" else "black"
    middle = left + width / 2.0
    name = "\n".join(textwrap.wrap(outcome.value, letters))
    axes.text(middle, top + 0.36, name, ha="center", va="center", fontsize=8, fontweight="bold", color=ink)
    error = "" if outcome.error is None else f" {outcome.error:.1e}"  # the word too, for those who see no colour
    below = f"{outcome.kind.lower()}{error}"
    axes.text(middle, top + 0.76, below, ha="center", va="center", fontsize=8, color=ink)
