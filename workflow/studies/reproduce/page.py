"""A self-contained HTML page of statements, tables and figures. Knows no physics."""

import base64
import html
import io
from collections.abc import Sequence
from dataclasses import dataclass, field

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Statement:
    """What the paper says, beside what is found here.

    Attributes:
        says: the paper's statement.
        found: the numbers measured, as text with their uncertainties.
        holds: "holds", "holds with a correction", or "does not hold".
        correction: what should be said instead; may be empty.
    """

    says: str
    found: Sequence[str]
    holds: str
    correction: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure with the name of its file (without suffix) and its caption."""

    name: str
    figure: Figure
    caption: str


@dataclass(frozen=True)
class Section:
    """One section of the report."""

    title: str
    introduction: str
    statements: Sequence[Statement]
    pictures: Sequence[Picture] = field(default_factory=tuple)
    notes: Sequence[str] = field(default_factory=tuple)


def png(figure: Figure) -> bytes:
    """The figure as PNG."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=150)
    return out.getvalue()


def render(title: str, summary: str, sections: Sequence[Section], images: dict[str, bytes]) -> str:
    """The page; ``images`` holds the PNG of every picture by name."""
    return document(title, summary, "\n".join(_section(section, images) for section in sections))


def document(title: str, summary: str, body: str) -> str:
    """A whole page around what its body says in HTML."""
    return _PAGE.format(title=html.escape(title), summary=html.escape(summary), body=body)


def _section(section: Section, images: dict[str, bytes]) -> str:
    rows = "\n".join(_row(statement) for statement in section.statements)
    pictures = "\n".join(shown(picture, images[picture.name]) for picture in section.pictures)
    notes = "".join(f"<p>{html.escape(note)}</p>" for note in section.notes)
    table = (
        "<table><thead><tr><th>the paper says</th><th>found here</th><th></th></tr></thead>"
        f"<tbody>{rows}</tbody></table>"
    )
    return (
        f"<section><h2>{html.escape(section.title)}</h2><p>{html.escape(section.introduction)}</p>"
        f"{table}{notes}{pictures}</section>"
    )


def _row(statement: Statement) -> str:
    found = "<br>".join(html.escape(line) for line in statement.found)
    correction = f"<br><em>{html.escape(statement.correction)}</em>" if statement.correction else ""
    kind = {"holds": "yes", "does not hold": "no"}.get(statement.holds, "partly")
    return (
        f"<tr><td>{html.escape(statement.says)}</td><td>{found}</td>"
        f'<td class="{kind}"><strong>{html.escape(statement.holds)}</strong>{correction}</td></tr>'
    )


def shown(picture: Picture, image: bytes) -> str:
    """A picture, whose PNG is part of the page, with its caption."""
    data = base64.b64encode(image).decode("ascii")
    caption = html.escape(picture.caption)
    return (
        f'<figure><img alt="{caption}" src="data:image/png;base64,{data}"><figcaption>{caption}</figcaption></figure>'
    )


_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }}
h1, h2 {{ line-height: 1.2; }}
table {{ border-collapse: collapse; width: 100%; margin: 1rem 0; }}
th, td {{ text-align: left; vertical-align: top; padding: .5rem .7rem; border-bottom: 1px solid #ccc; }}
table {{ table-layout: fixed; }}
th:nth-child(1) {{ width: 26%; }}
th:nth-child(2) {{ width: 44%; }}
.yes strong {{ color: #005a32; }}
.partly strong {{ color: #8a4b00; }}
.no strong {{ color: #a50f15; }}
figure {{ margin: 1.5rem 0; }}
img {{ max-width: 100%; height: auto; }}
figcaption {{ color: #555; font-size: .9rem; }}
</style>
</head>
<body>
<h1>{title}</h1>
<p>{summary}</p>
{body}
</body>
</html>
"""
