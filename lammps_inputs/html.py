"""How things show themselves in a notebook: small pieces of HTML.

Examples:
    >>> html.table("Arrivals", ["bead", "time"], [[1, 0.5], [2, None]]).count("<td")
    4
    >>> html.text("v < 1")
    '<pre>v &lt; 1</pre>'
"""

import base64
from collections.abc import Iterable, Sequence
from html import escape

from lammps_inputs.numbers import known

_STYLE = "text-align: right; padding: 0 0.8em 0 0; white-space: nowrap"


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table that scrolls where it is wider than the page; what is in the cells is text, not markup.

    Of a float four digits are shown, and ``-`` for None and what is no number.
    """
    lines = [_row("th", head)] if head else []
    lines += [_row("td", row) for row in rows]
    caption = f"<caption style='text-align: left'>{escape(title)}</caption>"
    return f"<div style='overflow-x: auto'><table>{caption}{''.join(lines)}</table></div>"


def with_unit(name: str, unit: str) -> str:
    """Head of a column, such as ``arrival (s)``; the name alone of what has no unit."""
    return f"{name} ({unit})" if unit else name


def _row(tag: str, cells: Sequence[object]) -> str:
    row = "".join(f"<{tag} style='{_STYLE}'>{escape(_cell(cell))}</{tag}>" for cell in cells)
    return f"<tr>{row}</tr>"


def _cell(value: object) -> str:
    if value is None or (isinstance(value, float) and known(value) is None):
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def image(png: bytes) -> str:
    """Image that is part of the page."""
    return f'<img src="data:image/png;base64,{base64.b64encode(png).decode()}" style="max-width: 100%" />'


def text(words: str) -> str:
    """Text as it is, line by line."""
    return f"<pre>{escape(words)}</pre>"
