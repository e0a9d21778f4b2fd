"""What points of error against cost say: the Pareto front, orders of convergence, and which setting to take."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workflow.studies.trade.harness import Point

LARGEST = 0.1
"""Errors from here on say nothing about an order."""


@dataclass(frozen=True)
class Order:
    """Slope of log error over log step.

    Attributes:
        value: by regression.
        spread: its standard error; NaN from two points.
        points: how many.
        low, high: smallest and largest step that went in.
    """

    value: float
    spread: float
    points: int
    low: float
    high: float


def pareto(points: Sequence[Point[Any]], error: str, cost: str) -> list[Point[Any]]:
    """The points that no other beats in both error and cost, in the order of rising cost."""
    known = [point for point in points if point.measured and math.isfinite(point.errors[error])]
    front: list[Point[Any]] = []
    for point in sorted(known, key=lambda point: (point.cost(cost), point.errors[error])):
        if not front or point.errors[error] < front[-1].errors[error]:
            front.append(point)
    return front


def order(points: Sequence[Point[Any]], error: str, floor: float) -> Order | None:
    """Order of one curve whose values are steps; None where fewer than two steps have an error that tells it.

    Args:
        points: of the curve.
        error: which.
        floor: errors that are not above it are left out, as are those not below `LARGEST`.
    """
    told = [point for point in points if point.measured and floor < point.errors[error] < LARGEST]
    steps = np.array([point.setting.value for point in told])
    if len(np.unique(steps)) < 2:
        return None
    x, y = np.log(steps), np.log([point.errors[error] for point in told])
    slope, start = np.polyfit(x, y, 1)
    spread = math.nan
    if len(x) > 2:
        left = y - slope * x - start
        spread = float(np.sqrt(left @ left / (len(x) - 2) / np.sum((x - x.mean()) ** 2)))
    return Order(float(slope), spread, len(x), float(steps.min()), float(steps.max()))


def cheapest(
    points: Sequence[Point[Any]], accuracy: float, error: str, cost: str, *, floor: float = 0.0
) -> Point[Any] | None:
    """The cheapest point whose error is within the accuracy, the reference's own error added; None if none is."""
    within = [point for point in points if point.measured and point.errors[error] + floor <= accuracy]
    return min(within, key=lambda point: point.cost(cost), default=None)


Pair = tuple[float, float]


def pairs(points: Sequence[Point[Any]], error: str, cost: str, floor: float) -> list[Pair]:
    """(error, cost) of those points of a curve that no other of it beats and whose error tells something."""
    return [
        (point.errors[error], point.cost(cost))
        for point in pareto(points, error, cost)
        if floor < point.errors[error] < LARGEST
    ]


def better_from(first: Sequence[Pair], second: Sequence[Pair]) -> tuple[float, float, float] | None:
    """Where the first of two curves of (error, cost) is cheaper at the same error.

    Both are read as straight lines from point to point in logarithms, over the errors that both reach.

    Returns:
        (largest error from which on, downwards, the first is cheaper: 0 where it nowhere is; smallest error; largest
        error that both reach), or None where they have no error in common.
    """
    curves = [np.log(np.array(sorted(curve)).reshape(-1, 2)) for curve in (first, second)]
    if any(len(curve) < 2 for curve in curves):
        return None
    low, high = max(curve[0, 0] for curve in curves), min(curve[-1, 0] for curve in curves)
    if not low < high:
        return None
    errors = np.linspace(low, high, 400)
    cheaper = np.interp(errors, *curves[0].T) < np.interp(errors, *curves[1].T)
    start = len(errors) if cheaper.all() else int(np.argmin(cheaper))
    found = float(np.exp(errors[start - 1])) if start else 0.0
    return found, float(np.exp(low)), float(np.exp(high))
