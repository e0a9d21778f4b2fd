"""Results of a run in numbers on its page: the sentences and tables that `granchain analyze` prints."""

from collections.abc import Iterable
from html import escape

from granchain.parts import html, screen


def results(lines: Iterable[str | screen.PrintedTable]) -> str:
    """Sentences of an analysis, and below them its tables, which unfold."""
    sentences, tables = [], []
    for line in lines:
        if isinstance(line, str):
            sentences.append(f"<p>{escape(sentence(line))}</p>")
        else:
            table = html.table("", line.head, line.rows)
            tables.append(f"<details><summary>{escape(line.title)}</summary>{table}</details>")
    return f'<details open id="results"><summary>Results</summary>{"".join((*sentences, *tables))}</details>'


def sentence(text: str) -> str:
    """Text with a capital letter and a full stop."""
    return f"{text[0].upper()}{text[1:]}."
