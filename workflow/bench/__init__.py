"""Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise)."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from workflow.bench import against_usual_ways, collisions, reference, sweeps, window
from workflow.bench.ratio import Ratio

__all__ = ["Ratio", "all_ratios"]


def all_ratios() -> Iterator[Ratio]:
    """Every measurement, one after the other; some six minutes, and 2 GB of temporary files."""
    with tempfile.TemporaryDirectory(prefix="granchain-bench-") as name:
        yield from against_usual_ways.all_ratios(Path(name))
        yield from sweeps.sweep_ratios(Path(name) / "sweep")
    yield from reference.reference_against_scipy()
    yield from collisions.collision_ratios()
    yield from window.window_ratios()
