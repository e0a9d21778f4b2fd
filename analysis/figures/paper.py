"""Width that figures are drawn for, apart from matplotlib, which takes half a second to import."""

from contextvars import ContextVar

WIDTH: ContextVar[float | None] = ContextVar("width", default=None)
"""Inches, such as 3.4 for one column of a journal and 7 for two, without a title; None: each its own, with a title."""

NARROW = 5.0
"""Inches below which letters are smaller, and legends stand below the panels."""
