"""Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise)."""

import importlib
import statistics
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

PARTS = {
    "hand": "commands:hand_ratios",
    "output": "alternatives:output_cost",
    "check": "alternatives:check_cost",
    "deck": "alternatives:tuned_against_plain",
    "reader": "alternatives:reader_ratios",
    "ingredients": "decks:ingredient_ratios",
    "sweep": "commands:sweep_ratios",
    "reference": "engines:reference_against_scipy",
    "collisions": "engines:collision_ratios",
    "window": "decks:window_ratios",
}
"""Measurements by name; all take some six minutes, and 2 GB of temporary files."""


@dataclass(frozen=True)
class Ratio:
    """One measured ratio.

    Attributes:
        name: what is compared.
        value: the ratio.
        goal: what it should be, in words.
        reached: whether it is.
        detail: the two measurements.
    """

    name: str
    value: float
    goal: str
    reached: bool
    detail: str


def make_ratio(name: str, value: float, goal: float, detail: str, *, below: bool = False) -> Ratio:
    """A ratio that should be at least the goal, or at most it with ``below``."""
    reached = value <= goal if below else value >= goal
    return Ratio(name, value, f"{'at most' if below else 'at least'} {goal:g}", reached, detail)


def ratio_of(name: str, pairs: Sequence[tuple[float, float]], goal: float, *, below: bool = False) -> Ratio:
    """The median of the second over the first of pairs of seconds."""
    values = [second / first for first, second in pairs]
    first, second = (statistics.median(side) for side in zip(*pairs, strict=True))
    detail = f"{first:.4g} s, {second:.4g} s; {min(values):.3g} to {max(values):.3g}"
    return make_ratio(name, statistics.median(values), goal, detail, below=below)


def measure(name: str) -> Iterator[Ratio]:
    """The ratios of one part."""
    module, _, function = PARTS[name].partition(":")
    part = getattr(importlib.import_module(f"workflow.studies.bench.{module}"), function)
    with tempfile.TemporaryDirectory(prefix="granchain-bench-") as root:
        yield from part(Path(root) / name)
