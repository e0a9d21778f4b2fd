"""Golden texts: what a test expects as a file in the folder `golden` beside it, so that its diff shows what changed.

``pytest --update-golden PATHS`` writes them anew. A test takes the fixture `golden` and calls ``golden(name, text)``:

- words and whole numbers must be as they are in the file, whatever spaces stand between them;
- other numbers may differ by a share of `RELATIVE`, as last digits differ by machine;
- what differs by run stands in `MASKED` or is given as ``masks``: patterns, and the words that take their place.
"""

import difflib
import math
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

RELATIVE = 2e-5
"""Numbers are written with six digits or fewer."""

MASKED: Mapping[str, str] = {
    r"\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d)?([+-]\d\d:?\d\d)?": "DATE",
    r"\b(in|took|after) \d+(\.\d+)?( ms| s| min)\b": r"\1 SECONDS",
    rf"{re.escape(tempfile.gettempdir())}/[^\s'\"<>:,]*": "DIRECTORY",
}

_NUMBER = re.compile(r"([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)")


def masked(text: str, masks: Mapping[str, str]) -> str:
    """The text with words in place of what differs by run."""
    for pattern, word in {**masks, **MASKED}.items():
        text = re.sub(pattern, word, text)
    return text


def agree(expected: str, given: str, relative: float = RELATIVE) -> bool:
    """Whether two texts have the same words and numbers."""
    left, right = (_NUMBER.split(" ".join(text.split())) for text in (expected, given))
    return len(left) == len(right) and all(
        one == other or bool(place % 2 and _close(one, other, relative))
        for place, (one, other) in enumerate(zip(left, right, strict=True))
    )


def _close(one: str, other: str, relative: float) -> bool:
    whole = all(re.fullmatch(r"[-+]?\d+", number) for number in (one, other))
    return not whole and math.isclose(float(one), float(other), rel_tol=relative)


def compare(file: Path, text: str, *, update: bool, masks: Mapping[str, str], relative: float) -> None:
    """Compare a text with a file line by line, or write the file.

    Raises:
        AssertionError: if they do not agree; with the lines that differ.
    """
    given = masked(text, masks).rstrip("\n") + "\n"
    expected = file.read_text(encoding="utf-8") if file.exists() else ""
    lines = [kept.splitlines() for kept in (expected, given)]
    same = len(lines[0]) == len(lines[1]) and all(map(lambda a, b: agree(a, b, relative), *lines))
    if update and not same:
        file.parent.mkdir(exist_ok=True)
        file.write_text(given, encoding="utf-8")
    elif not same:
        changes = "\n".join(difflib.unified_diff(*lines, str(file), "now", n=0, lineterm=""))
        raise AssertionError(f"{changes}\nif that is right: pytest --update-golden {file.parent.parent}")
