"""A figure as the content of a file."""

import io
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from analysis.figures.style import STYLE

_PACKED = {"compress_level": 3}
"""Half the time of the usual 6, for files that are a tenth larger."""


def picture(figure: Figure, suffix: str, dpi: float = STYLE["savefig.dpi"]) -> bytes:
    """What a file of this kind holds.

    Figures are laid out once, and PNG is drawn once; matplotlib on its own draws each file twice.

    Args:
        figure: what to draw.
        suffix: ``png``, ``pdf`` or ``svg``.
        dpi: dots per inch of what is not drawn with lines.
    """
    out = io.BytesIO()
    with mpl.rc_context(STYLE):  # fonts are settings of saving, too
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
