"""Cut pages that have several headings of the first level: a page for each section, and one with their contents."""

import itertools
import posixpath
import re
from collections.abc import Iterator
from dataclasses import dataclass

FENCE = "```"
LINK = re.compile(r"\]\(([^)#\s]*)#([^)\s]+)\)")
ANY_LINK = re.compile(r"\]\(([^)#\s]*)((?:#[^)\s]*)?)\)")
FURTHER = "Further pages:\n\n"
"""What stands above the links from a page to those of plug-ins."""

ENTRY = re.compile(r"^- \[([^]]+)\]\(([^)#\s]*plugins/[^)#\s]+)#([^)\s]+)\)$", re.MULTILINE)
"""Link to a section of another page, alone in an entry of a list."""

SENTENCE = re.compile(r"(`[^`]*`|[^`])+?(?=[.:]( |$))")

NO_PARAGRAPH = ("<!--", "|", FENCE, "![", "- ", "    ")
"""Beginnings of blocks that are no paragraphs."""


@dataclass(frozen=True)
class Section:
    """A section of a page, from a heading of the second level to the next.

    Attributes:
        part: heading of the first level above it.
        title: its own heading.
        name: file name of its page, which lies beside the one that it was cut from.
        text: the page.
    """

    part: str
    title: str
    name: str
    text: str


@dataclass(frozen=True)
class CutPage:
    """A page in sections.

    Attributes:
        overview: what stands above the sections, with a list of them for each part.
        sections: the pages of the sections, in their order.
    """

    overview: str
    sections: list[Section]


def headings(text: str) -> Iterator[tuple[int, int, str]]:
    """Number of the line, level and title of each heading of the first two levels that stands in no code."""
    code = False
    for number, line in enumerate(text.splitlines()):
        code ^= line.startswith(FENCE)
        if not code and (match := re.match(r"(##?) (.+)", line)):
            yield number, len(match[1]), match[2]


def anchor(title: str) -> str:
    """Name of the place of a heading in its page."""
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", title).strip().lower())


def has_parts(text: str) -> bool:
    """Whether a page has several headings of the first level, of which no contents can be made."""
    return sum(level == 1 for _, level, _ in headings(text)) > 1


def cut(text: str, stem: str) -> CutPage:
    """Cut a page; files of its sections begin with a stem."""
    lines = text.splitlines()
    starts = [*headings(text), (len(lines), 0, "")]
    overview, sections, part = [""], [], ""
    for (start, level, title), (end, _, _) in itertools.pairwise(starts):
        body = "\n".join(lines[start + 1 : end]).strip()
        if level == 1:
            overview += [f"{'## ' if part else '# '}{title}", *filter(None, [body]), ""]
            part = title
        else:
            sections.append(Section(part, title, f"{stem}-{anchor(title)}.md", f"# {title}\n\n{body}\n"))
            overview[-1] += f"- [{title}]({sections[-1].name}){first_sentence(body)}\n"
    return CutPage("\n\n".join(block.strip() for block in overview if block) + "\n", sections)


def first_sentence(body: str) -> str:
    """The first sentence of a section, after a colon; nothing where it begins otherwise."""
    paragraph = " ".join(body.split("\n\n")[0].split())
    sentence = SENTENCE.match(paragraph)
    return "" if sentence is None or paragraph.startswith(NO_PARAGRAPH) else f": {sentence[0]}."


def moved(path: str, page: CutPage) -> dict[tuple[str, str], str]:
    """Places of a page that was cut, as path and anchor -> path of the page on which they are now."""
    folder = posixpath.dirname(path)
    places = {(path, anchor(one.title)): posixpath.join(folder, one.name) for one in page.sections}
    return {(path, anchor(one.part)): f"{path}#{anchor(one.part)}" for one in page.sections} | places


def relinked(text: str, path: str, places: dict[tuple[str, str], str], *, anchors: bool = False) -> str:
    """The text that stood at a path, with its links to places that have moved; with their anchors where these stay."""
    folder = posixpath.dirname(path)

    def link(match: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(folder, match[1])) if match[1] else path
        place = places.get((target, match[2]))
        if place is None:
            return match[0]
        page = "" if place == path else posixpath.relpath(place, folder or ".")
        return f"]({page}#{match[2]})" if anchors else f"]({page})"

    return LINK.sub(link, text)


def titles(text: str) -> list[str]:
    """Headings of the second level."""
    return [title for _, level, title in headings(text) if level == 2]


def with_pages(text: str, path: str, pages: dict[str, str]) -> str:
    """A page with the sections of other pages in place of the lists of links to them.

    Args:
        text: the page, in which ``- [Title](PATH#title)`` names a section.
        path: its path.
        pages: path -> text of the other pages.
    """
    sections = {}
    for other, content in pages.items():
        lines = content.splitlines()
        starts = [*(entry for entry in headings(content) if entry[1] == 2), (len(lines), 0, "")]
        for (start, _, title), (end, _, _) in itertools.pairwise(starts):
            body = "\n".join(lines[start:end]).strip()
            sections[other, anchor(title)] = _moved_links(body, other, path)

    def section(match: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(posixpath.dirname(path), match[2]))
        return f"\n{sections[target, match[3]]}\n"

    return ENTRY.sub(section, text.replace(FURTHER, ""))


def _moved_links(text: str, path: str, target: str) -> str:
    """The text of a page as it stands at another path: its links lead where they did."""
    old, new = posixpath.dirname(path), posixpath.dirname(target)

    def link(match: re.Match[str]) -> str:
        if ":" in match[1]:
            return match[0]
        page = posixpath.normpath(posixpath.join(old, match[1])) if match[1] else path
        return f"]({posixpath.relpath(page, new)}{match[2]})"

    return ANY_LINK.sub(link, text)


def with_sections(navigation: str, path: str, page: CutPage) -> str:
    """The navigation, in TOML, with the sections of a page below its contents."""
    folder = posixpath.dirname(path)
    parts: dict[str, list[str]] = {}
    for one in page.sections:
        parts.setdefault(one.part, []).append(f'{{ "{one.title}" = "{posixpath.join(folder, one.name)}" }}')
    below = [f'{{ "{part}" = [{", ".join(entries)}] }}' for part, entries in parts.items()]
    assert navigation.count(f'= "{path}"') == 1
    return navigation.replace(f'= "{path}"', f'= [{{ "Contents" = "{path}" }}, {", ".join(below)}]')
