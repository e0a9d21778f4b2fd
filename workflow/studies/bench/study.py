"""Measure the speed of granchain's components against alternative implementations.

Ratios of two ways to do the same thing, measured side by side on this machine (absolute times are noise).
"""

import argparse
import importlib
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from analysis.quantity import declare, result
from workflow.errors import RunError
from workflow.studies.options import add_parts, refuse_unknown_parts
from workflow.studies.study import print_records

PARTS = {
    "window": "runs:window_ratios",
    "reader": "runs:reader_ratios",
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


# --- command ----------------------------------------------------------------------------------------------------------

EXAMPLES = (
    "bench",
    "bench window reader",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which parts."""
    add_parts(parser, PARTS)


def execute(arguments: argparse.Namespace) -> int:
    """Print a table of ratios, also where a part failed; exit code 1 if one failed or a ratio misses its goal."""
    refuse_unknown_parts("bench", arguments.parts, PARTS)
    ratios: list[Ratio] = []
    failed = []
    try:
        for name in arguments.parts or PARTS:
            try:
                for ratio in measure(name):
                    print(f"{ratio.name}: {ratio.value:.3g}", flush=True)
                    ratios.append(ratio)
            except Exception as error:  # whatever it is, the other parts are measured
                failed.append(f"{name} ({type(error).__name__}: {error})")
    finally:
        if ratios:
            print()
            print_records("measured side by side, medians", Ratio, ratios)
    if failed:
        raise RunError(f"bench: failed: {', '.join(failed)}")
    return 1 if any(ratio.verdict for ratio in ratios) else 0
