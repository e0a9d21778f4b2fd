"""Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise)."""

import importlib
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from analysis.quantity import declare, result

PARTS = {
    "window": "decks:window_ratios",
    "reader": "reader:reader_ratios",
    "check": "runs:check_ratios",
    "sweep": "runs:sweep_ratios",
    "reference": "engines:reference_ratios",
    "collisions": "engines:collision_ratios",
}
"""Measurements by name; all take some five minutes, and 2 GB of temporary files."""


@result
class Ratio:
    """One measured ratio."""

    name: str = declare("what is compared", digits="", head="what")
    value: float = declare("the ratio", digits=".3g", head="found")
    goal: str = declare("what it should be", digits="")
    verdict: str = declare("MISSED where it is not", digits="", head="")
    detail: str = declare("the two measurements", digits="", head="first, second, range")


def make_ratio(name: str, value: float, goal: float, detail: str, *, below: bool = False) -> Ratio:
    """A ratio that should be at least the goal, or at most it with ``below``."""
    reached = value <= goal if below else value >= goal
    return Ratio(name, value, f"{'at most' if below else 'at least'} {goal:g}", "" if reached else "MISSED", detail)


def ratio_of(name: str, pairs: Sequence[tuple[float, float]], goal: float, *, below: bool = False) -> Ratio:
    """The median of the second over the first of pairs of seconds."""
    values = [second / first for first, second in pairs]
    first, second = (statistics.median(side) for side in zip(*pairs, strict=True))
    detail = f"{first:.4g} s, {second:.4g} s; {min(values):.3g} to {max(values):.3g}"
    return make_ratio(name, statistics.median(values), goal, detail, below=below)


def seconds(work: Callable[[], object], clock: Callable[[], float] = time.perf_counter) -> float:
    """Wall time of a call, or that of another clock."""
    started = clock()
    work()
    return clock() - started


def measure(name: str) -> Iterator[Ratio]:
    """The ratios of one part."""
    module, _, function = PARTS[name].partition(":")
    part = getattr(importlib.import_module(f"workflow.studies.bench.{module}"), function)
    with tempfile.TemporaryDirectory(prefix="granchain-bench-") as root:
        yield from part(Path(root))
