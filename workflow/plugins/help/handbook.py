"""The scene reference `SCENES.md` as text for a terminal, section by section."""

import functools
import importlib.resources
import inspect
import re
import textwrap
from collections.abc import Iterator

from granchain.parts import registry, schema, units

WIDTH = 100
INDENT = " " * 6


@functools.cache
def page(name: str = "SCENES.md") -> str:
    """The page, in Markdown."""
    return (importlib.resources.files("lammps_inputs") / name).read_text(encoding="utf-8")


def scenes() -> str:
    """The whole page."""
    return _plain(page())


def keys() -> list[str]:
    """All keys of a scene that have a section."""
    return [key for names, _ in sections() for key in names]


def of_key(name: str) -> str | None:
    """The section of a key, or of that which a key such as ``coupling.rows`` belongs to; None where there is none."""
    if not re.fullmatch(r"[a-z_]+([.\[][a-z0-9_.\]]*)?", name):
        return None
    key = re.split(r"[.[]", name)[0]
    return next((_plain(section) for names, section in sections() if key in names), None)


def of_ingredient(name: str) -> str | None:
    """What the class of an ingredient says of itself and its keys, as of other packages; None where there is none.

    Args:
        name: key of a scene, or a key within it such as ``bed.quintic``.
    """
    key = name.partition(".")[0]
    if (kind := registry.INGREDIENTS.get(key)) is None:
        return None
    meaning, rows = schema.meanings(kind), ["| key | unit | default | meaning |", "|---|---|---|---|"]
    for label, field in kind.model_fields.items():
        symbols = [part.si for part in field.metadata if isinstance(part, units.Unit) and isinstance(part.si, str)]
        default = "required" if field.is_required() else "" if field.default is None else str(field.default)
        rows.append(f"| `{label}` | {''.join(symbols)} | {default} | {meaning.get(label, '')} |")
    parts = [f"# {key}", inspect.getdoc(kind) or "", "\n".join(rows)]
    parts += [f"```\n{key}: {kind.example}\n```"] if kind.example else []
    return _plain("\n\n".join(parts))


def of_word(word: str) -> str | None:
    """The section that has a word in its tables or code, such as a key within a key or one of its values.

    Where there are several, of each what it says of the word; None where there are none.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_-]{2,}", word):  # shorter ones are symbols
        return None
    pattern = re.compile(rf"(?<![\w-]){word}(?![\w-])")

    def having(code: str) -> list[tuple[list[str], str]]:
        return [section for section in sections() if any(map(pattern.search, re.findall(code, section[1], re.M)))]

    matches = having(r"^\| `[^|]*") or having(r"`([^`\n]*)`")
    if len(matches) == 1:
        return _plain(matches[0][1])
    entries = [
        f"  in {names[0]}:\n{textwrap.indent(_blocks_with(section, pattern), '  ')}" for names, section in matches
    ]
    return "\n".join([word, *entries]) if entries else None


def _blocks_with(section: str, pattern: re.Pattern[str]) -> str:
    """Rows of tables whose first cell has a word; without any all rows, items and paragraphs that have it."""
    rows, others = [], []
    for block in re.split(r"\n\n+", re.sub(r"<!--.*?-->\n?", "", section)):
        lines = block.splitlines()
        if block.startswith("|"):
            rows += [[*lines[:2], line] for line in lines[2:] if pattern.search(line.split(" | ")[0])]
            others += [[*lines[:2], line] for line in lines[2:] if pattern.search(line)]
        elif block.startswith("- "):
            others += [[f"- {item}"] for item in re.split(r"^- ", block, flags=re.M)[1:] if pattern.search(item)]
        elif pattern.search(block) and not block.startswith(("#", "```", "!")):
            others.append(lines)
    return "\n".join(_plain("\n".join(lines)) for lines in rows or others) or _plain(section)


def mentions(phrase: str) -> Iterator[tuple[str, str]]:
    """Key of each section that has a phrase, and what it says of that."""
    pattern = re.compile(re.escape(phrase), re.I)
    for names, section in sections():
        if pattern.search(section):
            yield names[0], _blocks_with(section, pattern)


def of_term(word: str) -> str | None:
    """A symbol or term as the tables of units and notation in `MODEL.md` define it; None where they do not."""
    meanings = [meaning for names, meaning in terms() if word in names]
    lines = [f"    {line}" for meaning in meanings for line in textwrap.wrap(meaning, WIDTH - 4)]
    return "\n".join([word, *lines]) if lines else None


@functools.cache
def terms() -> tuple[tuple[list[str], str], ...]:
    """Symbols and names of every term in the tables of units and notation of `MODEL.md`, and its meaning."""
    tables = page("MODEL.md").partition("## Units")[2].partition("## References")[0]
    rows = [_plain_math(row).strip("| ").split(" | ") for row in re.findall(r"^\|.*\|$", tables, re.M)]
    return tuple((re.split(r", | \(|\)", _unmarked(term)), _unmarked(": ".join(rest))) for term, *rest in rows)


def of_part_of_model(title: str) -> str | None:
    """The section or titled paragraph of `MODEL.md` with a title in any case, such as ``notation``; None of others."""
    text = page("MODEL.md")
    parts = {part.partition("\n")[0]: part for part in re.split(r"^## ", text, flags=re.M)[1:]}
    parts |= {
        match[1]: match[0] for match in re.finditer(r"^\*\*([^*]+)\.\*\*.*?(?=\n\n\*|\n\n## )", text, re.M | re.S)
    }
    section = next((part for name, part in parts.items() if name.lower() == title.lower()), None)
    return None if section is None else _plain(re.sub(r"(?<!\^)\*+([^*]+)(?<!\^)\*+", r"\1", _plain_math(section)))


_IN_ONE_LINE = (
    (r" ?\\rvert ?", "| "),
    (r"\\lvert ?", "|"),
    (r"\\sqrt\{([^{}]*)\}", r"sqrt(\1)"),
    (r"\\t?frac(\d)(\d)", r"\1/\2"),
    (r"\\frac(\d)\{([^{}]*)\}", r"\1 / (\2)"),
    (r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1) / (\2)"),
    (r"\\dots", "..."),
    (r"\\le ", "<= "),
    (r"\\[ ,;]|\\q?quad", " "),
    (r"\\(\w+)", r"\1"),
    (r"\{", "("),
    (r"\}", ")"),
)
"""Patterns of formulas of TeX -> how they are written in one line, in this order."""


def _plain_math(text: str) -> str:
    """Text whose formulas, between dollar signs, are written in one line."""

    def formula(match: re.Match[str]) -> str:
        line = match[1]
        for pattern, plain in _IN_ONE_LINE:
            line = re.sub(pattern, plain, line)
        return line

    return re.sub(r"\$+([^$]+)\$+", formula, text)


@functools.cache
def sections() -> tuple[tuple[list[str], str], ...]:
    """Keys and text of every section."""
    with_keys = []
    for section in re.split(r"^(?=##? [^\n]*\n\n)", page(), flags=re.M):  # not comments in code
        head, _, _ = section.partition("\n")
        if head.startswith("## "):
            with_keys.append((head.removeprefix("## ").split(", "), section))
    return tuple(with_keys)


def _plain(markdown: str) -> str:
    """Markdown as it is read in a terminal: wrapped, rows of tables as entries, without marks and pictures."""
    lines: list[str] = []
    code = False
    for block in re.split(r"\n\n+", re.sub(r"<!--.*?-->\n?|^!\[.*\)\n\n?", "", markdown, flags=re.M).strip()):
        if lines and not code:
            lines.append("")
        if block.startswith("```") or code:
            code = not block.endswith("```")
            lines += [f"    {line}" for line in block.splitlines() if not line.startswith("```")]
        elif block.startswith("|"):
            lines += _entries(block.splitlines())
        elif block.startswith("#"):
            lines.append(block.lstrip("# "))
        elif block.startswith("- "):
            lines += _items(block)
        else:
            lines += textwrap.wrap(_unmarked(block), WIDTH, break_on_hyphens=False)
    return "\n".join(lines)


def _items(block: str) -> list[str]:
    """Items of a list, wrapped below their marks."""
    lines = []
    for item in re.split(r"^- ", block, flags=re.M)[1:]:
        lines += textwrap.wrap(
            _unmarked(item), WIDTH, initial_indent="  - ", subsequent_indent="    ", break_on_hyphens=False
        )
    return lines


def _entries(rows: list[str]) -> list[str]:
    """Rows of a table: the first cell; the meaning, where there is one; the others with their heads."""
    (_, *heads), _, *rest = ([_unmarked(cell) for cell in row.strip("|").split(" | ")] for row in rows)
    lines = []
    for first, *cells in rest:
        row = dict(zip(heads, cells, strict=True))
        meaning = row.pop("meaning", "")
        text = "; ".join(f"{head}: {cell}" for head, cell in row.items() if cell)
        lines.append(f"  {first}")
        for part in filter(None, (meaning, text)):
            lines += textwrap.wrap(part, WIDTH, initial_indent=INDENT, subsequent_indent=INDENT, break_on_hyphens=False)
    return lines


def _unmarked(text: str) -> str:
    """Text of Markdown without links, code marks and marks of titled paragraphs."""
    plain = re.sub(r"\*\*([A-Z][^*]*\.)\*\*", r"\1", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text))
    return " ".join(plain.replace("`", "").split())
