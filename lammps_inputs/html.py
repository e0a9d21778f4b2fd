"""How things show themselves in a notebook: small pieces of HTML."""

from collections.abc import Iterable, Sequence
from html import escape

_STYLE = "text-align: right; padding: 0 0.8em 0 0"


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table; what is in the cells is text, not markup."""
    lines = [_row("th", head)] if head else []
    lines += [_row("td", row) for row in rows]
    return f"<table><caption style='text-align: left'>{escape(title)}</caption>{''.join(lines)}</table>"


def _row(tag: str, cells: Sequence[object]) -> str:
    inner = "".join(f"<{tag} style='{_STYLE}'>{escape(str(cell))}</{tag}>" for cell in cells)
    return f"<tr>{inner}</tr>"


def text(words: str) -> str:
    """Text as it is, line by line."""
    return f"<pre>{escape(words)}</pre>"
