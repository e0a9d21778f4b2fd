"""What this folder's README says about scenes, key by key: one text for readers of the repository and of a terminal."""

import importlib.resources
import re
import textwrap
from collections.abc import Iterator

WIDTH = 100


def scenes() -> str:
    """The part about scenes, its tables as text."""
    lines = []
    for line in _section():
        cells = _cells(line)
        if cells is None:
            lines.append(_plain(line))
        elif cells[0] != "key":
            lines.append(_entry(cells))
    return "\n".join(lines).strip()


def keys() -> list[str]:
    """All keys of a scene that have an entry."""
    return [key for cells in _rows() for key in re.findall(r"`([a-z_]+)`", cells[0])]


def of_key(name: str) -> str | None:
    """The entry of a key, or of that which a key such as ``coupling.rows`` stands in; None where there is none."""
    for cells in _rows():
        if re.fullmatch(r"[a-z_]+([.\[][a-z0-9_.\]]*)?", name) and f"`{re.split(r'[.[]', name)[0]}`" in cells[0]:
            return _entry(cells)
    return None


def of_word(word: str) -> str | None:
    """The entries that have a word in code, such as a key within a part or one of its values.

    Where there are several, the keys that they stand at; None where there are none.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_-]{2,}", word):  # shorter ones are symbols
        return None
    whole = re.compile(rf"\b{word}\b")
    found = [cells for cells in _rows() if any(whole.search(code) for code in re.findall(r"`([^`]*)`", cells[1]))]
    if len(found) == 1:
        return _entry(found[0])
    places = ", ".join(_plain(cells[0]) for cells in found)
    return f"{word}\n    part of {places}; `granchain help KEY` explains each" if found else None


def _section() -> list[str]:
    text = (importlib.resources.files("lammps_inputs") / "README.md").read_text(encoding="utf-8")
    return text.split("\n## Scenes\n", 1)[1].split("\n## ", 1)[0].splitlines()


def _rows() -> Iterator[list[str]]:
    for line in _section():
        cells = _cells(line)
        if cells is not None and cells[0] != "key":
            yield cells


def _cells(line: str) -> list[str] | None:
    """Cells of a table's row; None of other lines; of the line below a head nothing but the key column's name."""
    if not line.startswith("|"):
        return None
    cells = [cell.strip() for cell in line.strip("|").split(" | ")]
    return ["key"] if set(line) <= set("|-") else cells


def _entry(cells: list[str]) -> str:
    default = f" (default: {_plain(cells[2])})" if len(cells) > 2 else ""
    return f"{_plain(cells[0])}\n" + textwrap.fill(
        _plain(cells[1]) + default, WIDTH, initial_indent="    ", subsequent_indent="    ", break_on_hyphens=False
    )


def _plain(text: str) -> str:
    """Markdown as it is read in a terminal."""
    return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text).replace("`", "").strip("|").rstrip()
