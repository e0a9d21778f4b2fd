"""Plug-ins that a test outside their folders, or one of two plug-ins, needs; `core_alone` deletes some."""

import os

import pytest

WITHOUT = frozenset(os.environ.get("GRANCHAIN_TESTS_WITHOUT", "").split())
"""Names of the plug-ins that `core_alone` has deleted from this copy of the tree; none in the tree itself."""


def needs(*names: str) -> pytest.MarkDecorator:
    """Mark of a test, or of one of its cases, that is skipped where one of these plug-ins is deleted."""
    return pytest.mark.skipif(bool(WITHOUT & set(names)), reason=lacking(names))


def skip_if_deleted(*names: str) -> None:
    """Skip the rest of a test where one of these plug-ins is deleted."""
    if WITHOUT & set(names):
        pytest.skip(lacking(names))


def lacking(names: tuple[str, ...]) -> str:
    """Reason of a skipped test: which of these plug-ins are deleted."""
    return f"without plug-in {', '.join(sorted(WITHOUT & set(names)))}"
