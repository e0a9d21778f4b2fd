"""Paragraphs and cells of the manual's pages, for the limits on their lengths."""

import re
from collections.abc import Iterator

LONGEST_PARAGRAPH = 90
"""Words of a paragraph or an item of a list."""

LONGEST_CELL = 200
"""Characters of a cell of a table: two lines of a table of two columns."""

_ITEM = re.compile(r"^\s*(?:[-*]|\d+\.) ")


def paragraphs(page: str) -> Iterator[str]:
    """Blocks of text lines between blank lines, without code, tables, headings and comments; each item of a list."""
    without_code = re.sub(r"^```.*?^```$|<!--.*?-->|^\$\$.*?\$\$$", "", page, flags=re.M | re.S)
    text = re.sub(r"^(#|\||!\[| {4}).*$", "", without_code, flags=re.M)
    for block in re.split(r"\n\s*\n", text):
        lines: list[str] = []
        for line in block.splitlines():
            if _ITEM.match(line) and lines:
                yield " ".join(lines)
                lines = []
            lines.append(line.strip())
        if lines:
            yield " ".join(lines)


def cells(page: str) -> Iterator[str]:
    """Cells of all tables."""
    for row in re.findall(r"^\|.*\|$", page, re.M):
        yield from (cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1])


def too_long(page: str) -> list[str]:
    """Beginnings of paragraphs and cells beyond the limits, each with its length."""
    long = [
        f"{len(text.split())} words: {text[:60]}" for text in paragraphs(page) if len(text.split()) > LONGEST_PARAGRAPH
    ]
    return long + [f"{len(cell)} characters: {cell[:60]}" for cell in cells(page) if len(cell) > LONGEST_CELL]


_COMMANDS = ("frac", "tfrac", "sqrt", "max", "sum", "int", "dots", "dot", "ddot", "lvert", "rvert", "quad", "qquad")
_COMMANDS += ("pi", "sin", "ln", "ll", "le")
"""Commands of TeX that are no symbols."""


def symbols(page: str) -> set[str]:
    """Latin and Greek letters of all formulas between dollar signs, without their subscripts."""
    formulas = " ".join(map("".join, re.findall(r"\$\$(.+?)\$\$|\$([^$]+)\$", page)))
    formulas = re.sub(r"_(\{[^}]*\}|\w)", " ", formulas)
    letters = set(re.findall(r"\\[A-Za-z]+|(?<![A-Za-z\\])[A-Za-z](?![A-Za-z])", formulas))
    return letters - {f"\\{command}" for command in _COMMANDS}
