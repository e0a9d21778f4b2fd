"""Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise)."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from workflow.studies.bench import against_usual_ways, collisions, hand, ingredients, reference, sweeps, window
from workflow.studies.bench.ratio import Ratio

__all__ = ["PARTS", "Ratio", "measure"]

Part = Callable[[Path], Iterator[Ratio]]

PARTS: Mapping[str, Part] = {
    "hand": hand.hand_ratios,
    "output": against_usual_ways.output_cost,
    "check": against_usual_ways.check_cost,
    "deck": against_usual_ways.tuned_against_plain,
    "reader": against_usual_ways.reader_ratios,
    "ingredients": ingredients.ingredient_ratios,
    "sweep": sweeps.sweep_ratios,
    "reference": lambda _: reference.reference_against_scipy(),
    "collisions": lambda _: collisions.collision_ratios(),
    "window": window.window_ratios,
}
"""Measurements by name; all take some six minutes, and 2 GB of temporary files."""


def measure(name: str) -> Iterator[Ratio]:
    """The ratios of one part."""
    with tempfile.TemporaryDirectory(prefix="granchain-bench-") as root:
        yield from PARTS[name](Path(root) / name)
