"""Formats and width of figures: PNG, each of its own width, unless a command was asked for others; decided here.

Examples:
    >>> formats.figure_files("waves")
    ('waves.png',)
    >>> with formats.written_as(["pdf"], width=3.4):
    ...     formats.figure_files("waves"), formats.words()
    (('waves.pdf',), ['--formats', 'pdf', '--width', '3.4'])
"""

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

from analysis.figures.paper import WIDTH
from workflow.screen import meanwhile

KNOWN = ("png", "pdf", "svg")

LEAST_WIDTH, MOST_WIDTH = 2.0, 20.0
"""Inches of a figure."""

_asked: ContextVar[tuple[str, ...]] = ContextVar("formats", default=("png",))


def asked() -> tuple[str, ...]:
    """Formats that figures are written in now."""
    return _asked.get()


def width_asked() -> float | None:
    """Width of figures in inches; None where each has its own."""
    return WIDTH.get()


@contextmanager
def written_as(formats: Sequence[str], width: float | None = None) -> Iterator[None]:
    """Write figures in these formats, and of this width in inches without titles, in a block."""
    with meanwhile(_asked, tuple(formats)), meanwhile(WIDTH, width):
        yield


def words() -> list[str]:
    """Options of a command that writes figures as they are written now."""
    width = width_asked()
    return ["--formats", ",".join(asked()), *([] if width is None else ["--width", f"{width:g}"])]


def figure_files(*names: str) -> tuple[str, ...]:
    """Names of the files of figures, as they are written now."""
    return tuple(f"{name}.{suffix}" for name in names for suffix in asked())


def in_any_format(*names: str) -> tuple[str, ...]:
    """Names that the files of figures may have."""
    return tuple(f"{name}.{suffix}" for name in names for suffix in KNOWN)


def from_words(text: str) -> tuple[str, ...]:
    """Formats that ``--formats`` names."""
    names = tuple(dict.fromkeys(word.strip().lower() for word in text.split(",")))
    if not set(names) <= set(KNOWN):
        raise argparse.ArgumentTypeError(f"{text!r} given; of {', '.join(KNOWN)}, with commas between")
    return names


def width_from_words(text: str) -> float:
    """Inches that ``--width`` names."""
    try:
        inches = float(text)
    except ValueError:
        inches = 0.0
    if not LEAST_WIDTH <= inches <= MOST_WIDTH:
        raise argparse.ArgumentTypeError(
            f"{text!r} given; inches from {LEAST_WIDTH:g} to {MOST_WIDTH:g}, such as 3.4 for one column of a journal"
        )
    return inches
