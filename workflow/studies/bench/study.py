"""Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise)."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from workflow.studies.bench import alternatives, commands, decks, engines
from workflow.studies.bench.ratio import Ratio

__all__ = ["PARTS", "Ratio", "measure"]

Part = Callable[[Path], Iterator[Ratio]]

PARTS: Mapping[str, Part] = {
    "hand": commands.hand_ratios,
    "output": alternatives.output_cost,
    "check": alternatives.check_cost,
    "deck": alternatives.tuned_against_plain,
    "reader": alternatives.reader_ratios,
    "ingredients": decks.ingredient_ratios,
    "sweep": commands.sweep_ratios,
    "reference": lambda _: engines.reference_against_scipy(),
    "collisions": lambda _: engines.collision_ratios(),
    "window": decks.window_ratios,
}
"""Measurements by name; all take some six minutes, and 2 GB of temporary files."""


def measure(name: str) -> Iterator[Ratio]:
    """The ratios of one part."""
    with tempfile.TemporaryDirectory(prefix="granchain-bench-") as root:
        yield from PARTS[name](Path(root) / name)
