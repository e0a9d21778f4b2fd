"""What all figures share: colours, dashes, sizes, legends, and how one becomes the content of a file.

Plug-ins take this module so that their figures look like the others: a function that draws is `styled`, begins with
`new_figure`, takes colours from `CHAIN_COLOURS`, and ends with `label_axis`, `letter`, `head` and `legend_below`.
`picture` gives the content of a file. Titles are those of `panels`.

Examples:
    >>> @style.styled
    ... def speeds(beads, values):
    ...     figure = style.new_figure(2.5, 4.0)
    ...     figure.subplots().plot(beads, values, color=style.CHAIN_COLOURS[0])
    ...     style.head(figure, "one chain")
    ...     return figure
    >>> style.picture(speeds([10, 20], [0.62, 0.58]), "png", dpi=30)[1:4]
    b'PNG'
"""

import functools
import io
import math
import re
import string
import textwrap
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from typing import Any, ParamSpec, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from analysis.figures.paper import NARROW, WIDTH
from analysis.trajectory import Integers
from lammps_inputs.units import Label

CHAIN_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#882255", "#7F7F7F")
"""Okabe and Ito's palette, ordered for contrast between the first few; wine (Tol) and grey."""

CHAIN_DASHES: tuple[object, ...] = (
    "-",
    (0, (4, 1.5)),
    (0, (1, 1)),
    (0, (5, 1, 1, 1)),
    (0, (8, 2)),
    (0, (3, 1, 1, 1, 1, 1)),
    (0, (1, 2.5)),
    (0, (8, 2, 2, 2)),
    (0, (8, 1, 1, 1, 1, 1)),
)
"""One for each chain of a figure, so that chains can be distinguished in grey."""

_MOST_LABELS = 8

STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titley": 1.0,  # there, and not sought for, which takes as long as all else
    "figure.titlesize": 10,
    "lines.linewidth": 1.3,
    "hatch.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.use_mathtext": True,
    "legend.frameon": False,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""Settings of matplotlib for every figure (its own type lists some hundred keys)."""

_LEGEND_ROW = 0.2
"""Inches."""

_NARROW: Any = {"font.size": 8, "axes.titlesize": 8, "lines.linewidth": 1.0, "lines.markersize": 4}
"""Those of a figure as wide as one column of a journal."""

Parameters = ParamSpec("Parameters")
Drawn = TypeVar("Drawn")


def styled(draw: Callable[Parameters, Drawn]) -> Callable[Parameters, Drawn]:
    """A function that draws, with the settings of every figure and those of the width that is asked for."""

    @functools.wraps(draw)
    def in_style(*arguments: Parameters.args, **options: Parameters.kwargs) -> Drawn:
        with settings():
            return draw(*arguments, **options)

    return in_style


def settings() -> AbstractContextManager[None]:
    """Context in which what is drawn has the settings of every figure and those of the width that is asked for."""
    return mpl.rc_context({**STYLE, **(_NARROW if is_narrow() else {})})


def is_narrow() -> bool:
    """Whether figures are asked for that are as wide as one column of a journal."""
    width = WIDTH.get()
    return width is not None and width < NARROW


def new_figure(height: float, width: float = 7.0) -> Figure:
    """An empty figure, of the width that is asked for (`WIDTH`) if there is one, and then less high or higher.

    Args:
        height: in inches.
        width: in inches, where none is asked for.

    Returns:
        The figure, of matplotlib, whose layout makes room for all that it gets.
    """
    column = WIDTH.get()
    size = (width, height) if column is None else (column, height * math.sqrt(column / width))
    return Figure(figsize=size, layout="constrained")


def head(figure: Figure, text: str) -> None:
    """Write a title, but where a width is asked for: a journal has captions.

    Args:
        figure: figure whose panels are drawn.
        text: one line or several; long ones are broken.
    """
    if WIDTH.get() is None:
        figure.suptitle("\n".join(_wrapped(line, figure.get_figwidth()) for line in text.splitlines()))


def legend_below(figure: Figure, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """Put a legend below the panels, where it hides no curve, in as few rows as fit; the figure grows by these.

    Args:
        figure: figure whose panels are drawn.
        handles: curves and marks of matplotlib.
        labels: words of each of them.
    """
    if not handles:
        return
    inches = 0.5 + 0.06 * max(map(len, labels))  # of a column: a letter has about half its height of 9 points
    rows = math.ceil(len(handles) / max(1, int(figure.get_figwidth() / inches)))
    figure.set_figheight(figure.get_figheight() + _LEGEND_ROW * rows)
    figure.legend(handles, labels, loc="outside lower center", ncols=math.ceil(len(handles) / rows))


def legend_beside(figure: Figure, handles: Sequence[Any], labels: Sequence[str], **options: Any) -> None:
    """Put a legend to the right of the panels, below them in a narrow figure."""
    if is_narrow():
        legend_below(figure, handles, labels)
    else:
        figure.legend(handles, labels, loc="outside right center", **options)


def label_axis(setting: XAxis | YAxis, label: Label) -> None:
    """Write words, symbol and unit beside an axis, with a prefix or power of ten before the unit for short numbers.

    Args:
        setting: the axis, when all is drawn; a logarithmic one keeps the unit and its powers of ten.
        label: with the unit of what is drawn.
    """
    if setting.get_scale() == "log":
        setting.set_label_text(label.mathtext)
        return
    ends = np.abs(setting.get_view_interval())
    shown, worth = label.prefixed(float(np.max(ends[np.isfinite(ends)], initial=0.0)))
    setting.set_label_text(shown.mathtext)
    if worth != 1.0:
        setting.set_major_formatter(
            FuncFormatter(lambda value, _: f"{value * worth:.10g}".replace("-", "\N{MINUS SIGN}"))
        )


def label_log_axis(setting: XAxis | YAxis) -> None:
    """Label powers of ten, at most six; of few decades also digits between them, as plain numbers, as many as fit."""
    low, high = setting.get_view_interval()
    decades = math.log10(high / low)
    if decades > 3.0:
        setting.set_major_locator(LogLocator(numticks=6))
        setting.set_minor_formatter(NullFormatter())
        return
    few_fit = is_narrow() and isinstance(setting, XAxis)
    many, few = (0.4, 1.0) if few_fit else (0.9, 2.6)
    digits = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if decades < many else (1.0, 2.0, 5.0) if decades < few else (1.0,)
    setting.set_major_locator(LogLocator(subs=digits))
    setting.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    setting.set_minor_formatter(NullFormatter())


def letter(axes: Iterable[Axes]) -> None:
    """Letter the panels of a figure, (a), (b), ..., before their titles on the left; a single panel has no letter."""
    panels = list(axes)
    for axis, mark in zip(panels, string.ascii_lowercase if len(panels) > 1 else "", strict=False):
        axis.set_title(f"({mark}) {axis.get_title(loc='left')}".rstrip(), loc="left")


LETTERS_PER_INCH = 13
"""Letters of a title that fit into an inch."""


def _wrapped(line: str, width: float) -> str:
    """A line of a title in lines that fit into a width in inches, unbroken in formulas, at ``=`` and after numbers."""
    unbroken = re.sub(r"\$[^$]*\$", lambda formula: formula[0].replace(" ", "\0"), line)
    unbroken = re.sub(r" (?==)|(?<==) |(?<=\d) ", "\0", unbroken)
    return "\n".join(textwrap.wrap(unbroken, max(20, int(LETTERS_PER_INCH * width)))).replace("\0", " ")


def name_columns(axis: Axes, beads: Integers) -> None:
    """Write numbers of beads [bead] that are not evenly spaced under columns of one width, or under some of them."""
    named = np.unique(np.linspace(0, len(beads) - 1, min(len(beads), _MOST_LABELS)).round().astype(int))
    axis.set_xticks(named.tolist(), labels=[str(beads[place]) for place in named])
    axis.set_xlabel("recorded bead")


_PACKED = {"compress_level": 3}
"""Half the time of the usual 6, for files that are a tenth larger."""


@styled  # fonts are settings of saving, too
def picture(figure: Figure, suffix: str, dpi: float = STYLE["savefig.dpi"]) -> bytes:
    """What a file of this kind holds.

    Figures are laid out once, and PNG is drawn once; matplotlib on its own draws each file twice.

    Args:
        figure: what to draw.
        suffix: ``png``, ``pdf`` or ``svg``.
        dpi: dots per inch of what is not drawn with lines.
    """
    out = io.BytesIO()
    engine = figure.get_layout_engine()
    if engine is not None:
        figure.set_dpi(dpi)
        engine.execute(figure)
        figure.set_layout_engine("none")
    if suffix == "png":
        figure.set_dpi(dpi)
        canvas: Any = FigureCanvasAgg(figure)
        canvas.print_png(out, pil_kwargs=_PACKED)
    else:
        figure.savefig(out, format=suffix, dpi=dpi)
    return out.getvalue()
