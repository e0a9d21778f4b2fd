"""Published statements beside computed values: sections of a page, kept as files, and the page."""

import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from granchain.parts import page, references

SECTION = "section.json"

HOLDS, CORRECTED, FAILS = "holds", "holds with a correction", "does not hold"
VERDICTS = {HOLDS: "hold", CORRECTED: "hold with a correction", FAILS: "do not hold"}
"""Verdicts on a statement, and on several."""


@dataclass(frozen=True)
class Statement:
    """A published or derived claim beside the numbers measured, with a verdict.

    Attributes:
        published: the claim of a publication; empty where nothing was published.
        source: key of the bibliography, and the place in it, as ``rosas2007, abstract``; empty where nothing was
            published.
        derived: what follows from theory before anything is run; may be empty.
        found: the numbers measured, and where they are required to lie, line by line.
        holds: one of `HOLDS`, `CORRECTED` and `FAILS`.
        correction: what should be said instead; may be empty.
    """

    published: str
    source: str
    derived: str
    found: Sequence[str]
    holds: str
    correction: str = ""


@dataclass(frozen=True)
class Section:
    """One section of a page.

    Attributes:
        title, introduction: what it is about.
        statements: rows of the table.
        pictures: figures below the table.
        notes: paragraphs between the two.
        sources: key of the bibliography -> what could be read of the publication.
        tables: files of numbers, name -> text.
        failed: why there are no statements, where that is so.
    """

    title: str
    introduction: str
    statements: Sequence[Statement]
    pictures: Sequence[page.PageFigure] = field(default_factory=tuple)
    notes: Sequence[str] = field(default_factory=tuple)
    sources: Mapping[str, str] = field(default_factory=dict)
    tables: Mapping[str, str] = field(default_factory=dict)
    failed: str = ""

    @property
    def verdicts(self) -> dict[str, int]:
        """How many statements have each verdict."""
        verdicts = [statement.holds for statement in self.statements]
        return {verdict: verdicts.count(verdict) for verdict in VERDICTS}


def files_of(section: Section) -> dict[str, str | bytes]:
    """Files that hold a section in a folder of its own, by name, for `kept`: its text, pictures and tables."""
    captions = [{"name": picture.name, "caption": picture.caption} for picture in section.pictures]
    plain = {**asdict(replace(section, pictures=())), "pictures": captions}
    images = {f"{picture.name}.png": picture.image for picture in section.pictures}
    return {**images, **section.tables, SECTION: json.dumps(plain, indent=1) + "\n"}


def kept(folder: Path) -> Section | None:
    """The section of the files that `files_of` lists; None if there is none, or if it is damaged."""
    try:
        plain = json.loads((folder / SECTION).read_text(encoding="utf-8"))
        pictures = [
            page.PageFigure(entry["name"], (folder / f"{entry['name']}.png").read_bytes(), entry["caption"])
            for entry in plain["pictures"]
        ]
        statements = [Statement(**entry) for entry in plain["statements"]]
        return Section(**{**plain, "statements": statements, "pictures": pictures})
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None


def render(title: str, summary: str, sections: Sequence[Section]) -> str:
    """The page: a list of the sections with their verdicts, and the sections.

    Args:
        title, summary: head of the page; the summary is split into paragraphs at line ends.
        sections: the sections, in their order.
    """
    stated = [[statement.source.partition(", ")[0] for statement in section.statements] for section in sections]
    keys = [
        key for section, section_keys in zip(sections, stated, strict=True) for key in (*section.sources, *section_keys)
    ]
    cited = list(dict.fromkeys([key for key in keys if key] + references.ENGINES))
    contents = "".join(
        f'<li><a href="#s{number}">{html.escape(section.title)}</a> {_verdicts(section)}</li>'
        for number, section in enumerate(sections)
    )
    body = "\n".join(_section(section, number, cited) for number, section in enumerate(sections))
    return page.document(title, summary, f'<ol id="contents">{contents}</ol>\n{body}\n{_UP}', cited)


_UP = '<a class="up" href="#contents">contents</a>'
"""Link to the list of sections, visible everywhere on the page."""


def _verdicts(section: Section) -> str:
    if section.failed:
        return '<span class="no"><strong>failed</strong></span>'
    return ", ".join(
        f'<span class="{_kind(word)}"><strong>{count} {VERDICTS[word] if count > 1 else word}</strong></span>'
        for word, count in section.verdicts.items()
        if count
    )


def _kind(holds: str) -> str:
    return {HOLDS: "yes", FAILS: "no"}.get(holds, "partly")


def _section(section: Section, number: int, cited: Sequence[str]) -> str:
    head = f'<section id="s{number}"><h2>{html.escape(section.title)}</h2><p>{html.escape(section.introduction)}</p>'
    if section.failed:
        return f'{head}<p class="no"><strong>failed</strong>: {html.escape(section.failed)}</p></section>'
    rows = "\n".join(_row(statement, cited) for statement in section.statements)
    pictures = "\n".join(page.shown(picture) for picture in section.pictures)
    notes = "".join(f"<p>{html.escape(note)}</p>" for note in section.notes)
    read = "; ".join(f"{_cite(key, cited)} {html.escape(how)}" for key, how in section.sources.items())
    notes = f"<p>Sources: {read}.</p>{notes}" if read else notes
    heads = "".join(f"<th>{html.escape(head)}</th>" for head in HEADS)
    table = f'<table class="statements"><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>'
    return f"{head}{table}{notes}{pictures}</section>"


def _cite(key: str, cited: Sequence[str]) -> str:
    """The number of a publication on this page, as a link."""
    number = cited.index(key) + 1
    return f'<a href="#r{number}">[{number}]</a>'


HEADS = ("published", "derived here", "found", "verdict")


def _row(statement: Statement, cited: Sequence[str]) -> str:
    key, _, place = statement.source.partition(", ")
    source = f" {_cite(key, cited)}{html.escape(f', {place}' if place else '')}" if key else ""
    correction = f"<br><em>{html.escape(statement.correction)}</em>" if statement.correction else ""
    # numbers that no browser breaks at their signs
    lines = [re.sub(r"(?<=\de)-(?=\d)", "\N{NON-BREAKING HYPHEN}", line) for line in statement.found]
    cells = (
        html.escape(statement.published) + source or "-",
        html.escape(statement.derived) or "-",
        "".join(f"<p>{html.escape(line)}</p>" for line in lines),
    )
    verdict = f"<strong>{html.escape(statement.holds)}</strong>{correction}"
    kinds = ("", "", "", _kind(statement.holds))
    columns = zip(HEADS, kinds, (*cells, verdict), strict=True)
    texts = [f'<td class="{kind}" data-head="{head}">{cell}</td>' for head, kind, cell in columns]
    return f"<tr>{''.join(texts)}</tr>"
