"""What a benchmark says: one ratio, its goal, and whether it was reached."""

import statistics
from dataclasses import dataclass


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


def make_ratio(
    name: str,
    values: list[float],
    goal: float,
    *,
    times: list[tuple[float, float]],
    below: bool = False,
) -> Ratio:
    """A ratio of pairs of times: the median of ``values``, at least the goal, or at most it with ``below``."""
    value = statistics.median(values)
    first, second = (statistics.median(pair[side] for pair in times) for side in (0, 1))
    detail = f"{first:.4g} s, {second:.4g} s; {min(values):.3g} to {max(values):.3g}"
    reached = value <= goal if below else value >= goal
    return Ratio(name, value, f"{'at most' if below else 'at least'} {goal:g}", reached, detail)
