"""In which formats figures are written: PNG, unless a command was asked for others. The one place that decides."""

import argparse
from collections.abc import Sequence
from contextlib import AbstractContextManager
from contextvars import ContextVar

from workflow.screen import meanwhile

KNOWN = ("png", "pdf", "svg")

_asked: ContextVar[tuple[str, ...]] = ContextVar("formats", default=("png",))


def asked() -> tuple[str, ...]:
    """Formats that figures are written in now."""
    return _asked.get()


def written_as(formats: Sequence[str]) -> AbstractContextManager[None]:
    """Write figures in these formats meanwhile."""
    return meanwhile(_asked, tuple(formats))


def figure_files(*names: str) -> tuple[str, ...]:
    """Names of the files of figures, as they are written now."""
    return tuple(f"{name}.{suffix}" for name in names for suffix in asked())


def in_any_format(*names: str) -> tuple[str, ...]:
    """Names that the files of figures may have."""
    return tuple(f"{name}.{suffix}" for name in names for suffix in KNOWN)


def from_words(text: str) -> tuple[str, ...]:
    """What ``--formats`` says."""
    found = tuple(dict.fromkeys(word.strip().lower() for word in text.split(",")))
    if not set(found) <= set(KNOWN):
        raise argparse.ArgumentTypeError(f"{text!r} given; of {', '.join(KNOWN)}, with commas between")
    return found
