"""A self-contained HTML page of tables and figures.

Plug-ins take this module for reports of studies: `drawn` makes a figure a `PageFigure`, `shown` and `table` are parts
of a body, `document` is the page.

Examples:
    >>> body = page.table(["kappa", "amplitude"], [["0.1", "0.341"]])
    >>> _ = (tmp / "report.html").write_text(page.document("Scan", "Amplitudes.", body, cited=["nesterenko1983"]))
    >>> body.partition("<tr>")[2]
    '<th>kappa</th><th>amplitude</th></tr><tr><td>0.1</td><td>0.341</td></tr></table></div>'
"""

import base64
import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from analysis.figures.style import picture as content_of
from workflow.provenance import foot


@dataclass(frozen=True)
class PageFigure:
    """A figure as PNG, with the name of its file (without suffix) and its caption."""

    name: str
    image: bytes
    caption: str


def drawn(name: str, figure: Figure, caption: str) -> PageFigure:
    """A figure as PNG for a page.

    Args:
        name: name of its file, without suffix.
        figure: figure of matplotlib.
        caption: text below it.

    Returns:
        The figure for `shown`.
    """
    return PageFigure(name, content_of(figure, "png", dpi=150), caption)


def document(title: str, summary: str, body: str, cited: Iterable[str]) -> str:
    """A complete HTML page around a body.

    Args:
        title, summary: head of the page.
        body: HTML.
        cited: keys of the bibliography, for its last section (`workflow.provenance.foot`).

    Returns:
        The page, in HTML.
    """
    return (
        Path(__file__)
        .with_name("page.html")
        .read_text(encoding="utf-8")
        .format(
            title=html.escape(title), summary=html.escape(summary).replace("\n", "</p><p>"), body=body, foot=foot(cited)
        )
    )


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of text.

    Args:
        head: headings of the columns.
        rows: cells of each row.

    Returns:
        The table, in HTML.
    """
    lines = [("th", head), *(("td", row) for row in rows)]
    cells = ("".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in line) for tag, line in lines)
    return f'<div class="wide"><table>{"".join(f"<tr>{line}</tr>" for line in cells)}</table></div>'


def shown(picture: PageFigure) -> str:
    """A picture, whose PNG is part of the page, with its caption."""
    data = base64.b64encode(picture.image).decode("ascii")
    caption = html.escape(picture.caption)
    return (
        f'<figure><img alt="{caption}" src="data:image/png;base64,{data}"><figcaption>{caption}</figcaption></figure>'
    )
