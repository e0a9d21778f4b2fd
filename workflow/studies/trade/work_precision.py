"""Error against cost: settings run in rounds that take each in turn, and what the points say.

`measure` runs settings and keeps what injected functions measure; it is independent of what is run. A setting lies on a
curve (a method) at a value (its step, its width); ``effort`` is its work relative to others of its group, such as all
that one program does. Of the points follow the Pareto front, orders of convergence, and which setting to take.
"""

import math
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workflow.errors import RunError

Numbers = Mapping[str, float]


@dataclass(frozen=True)
class Setting:
    """One choice of the user's.

    Attributes:
        curve: name of the method.
        value: where on the curve; a step, a width, a number of ranks.
        label: the same in words.
        effort: work, relative to others of the group.
        what: whatever the run needs to know.
        group: curves whose times grow alike with the effort, if there are more than its own.
    """

    curve: str
    value: float
    label: str
    effort: float
    what: Any
    group: str = ""


@dataclass
class Point:
    """What a setting was found to do.

    Attributes:
        errors: by quantity; they are the same in every call.
        first: costs of the first call, which may load or compile.
        repeats: costs of the calls after it.
        left_out: why there are no numbers; empty where there are.
        spent: seconds that all calls took, with everything around them.
    """

    setting: Setting
    errors: dict[str, float] = field(default_factory=dict)
    first: dict[str, float] = field(default_factory=dict)
    repeats: list[dict[str, float]] = field(default_factory=list)
    left_out: str = ""
    spent: float = 0.0

    @property
    def measured(self) -> bool:
        """Whether there are numbers."""
        return bool(self.first)

    def costs(self, name: str) -> list[float]:
        """One cost in all repeats; that of the first call if there is no other."""
        return [each[name] for each in self.repeats or [self.first]]

    def cost(self, name: str) -> float:
        """Median of one cost."""
        return statistics.median(self.costs(name))


Points = Sequence[Point]


@dataclass(frozen=True)
class Limits:
    """How often settings are run, and how long that may take.

    Attributes:
        repeats: calls after the first.
        longest: seconds that one call may take; a setting that would take longer, by what others of its group took, is
            left out.
        patience: seconds after which a setting is not repeated a second time or more.
        budget: seconds after which nothing is repeated.
        clock: seconds.
    """

    repeats: int = 5
    longest: float = math.inf
    patience: float = math.inf
    budget: float = math.inf
    clock: Callable[[], float] = time.perf_counter


def measure(
    settings: Sequence[Setting],
    run: Callable[[Any], Any],
    errors: Callable[[Any], Numbers],
    costs: Callable[[Any], Numbers],
    limits: Limits,
    follow: Callable[[Points, int, int], None] | None = None,
) -> list[Point]:
    """Run every setting once, for its errors, and then up to ``repeats`` times more, in rounds, for its costs.

    Args:
        settings: those of one curve in the order of rising effort, if some are to be left out.
        run: computes what a setting names; `RunError` where that fails, which is noted.
        errors, costs: of a result, which is not kept.
        limits: of calls and time.
        follow: called after every call with all points, the calls done and an upper bound of all calls.

    Returns:
        a point for each setting, in their order.
    """
    points = [Point(setting) for setting in settings]
    done, total, started = 0, len(points) * (1 + limits.repeats), limits.clock()
    for number in range(1 + limits.repeats):
        for point in points:
            if number == 0:
                point.left_out = _too_long(point, points, limits.longest)
            elif (
                number > 1 and point.spent * (1.0 + 1.0 / number) > limits.patience
            ) or limits.clock() - started > limits.budget:
                total -= 1  # this and each later round
                continue
            if not point.left_out:
                _call(point, run, errors, costs, limits.clock)
            done += 1
            if follow is not None:
                follow(points, done, total)
    return points


def _too_long(point: Point, points: Points, longest: float) -> str:
    """Why a setting is not run; empty if it is."""
    setting = point.setting
    before = [other for other in points if other.measured and other.setting.effort <= setting.effort]
    own = [other for other in before if other.setting.curve == setting.curve]
    alike = [other for other in before if setting.group and other.setting.group == setting.group]
    told = own if len(own) > 1 or not alike else alike
    expected = _extrapolated(sorted((other.setting.effort, other.spent) for other in told), setting.effort)
    return f"would take {expected:.2g} s" if expected > longest else ""


def _extrapolated(known: Sequence[tuple[float, float]], effort: float) -> float:
    """Seconds of an effort, from the two nearest known below it, by a straight line; 0 if none is known."""
    if not known:
        return 0.0
    (last, seconds), slope = known[-1], 0.0
    for other, took in reversed(known[:-1]):
        if other < 0.9 * last:
            slope = max(0.0, (seconds - took) / (last - other))
            break
    return seconds + slope * (effort - last)


def _call(
    point: Point,
    run: Callable[[Any], Any],
    errors: Callable[[Any], Numbers],
    costs: Callable[[Any], Numbers],
    clock: Callable[[], float],
) -> None:
    started = clock()
    try:
        result = run(point.setting.what)
    except RunError as error:
        point.left_out = str(error)
        point.first, point.errors, point.repeats = {}, {}, []
        return
    if point.measured:
        point.repeats.append(dict(costs(result)))
    else:
        point.errors = dict(errors(result))
        point.first = dict(costs(result))
    point.spent += clock() - started


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


def pareto(points: Points, error: str, cost: str) -> list[Point]:
    """The points that no other beats in both error and cost, in the order of rising cost."""
    known = [point for point in points if point.measured and math.isfinite(point.errors[error])]
    front: list[Point] = []
    for point in sorted(known, key=lambda point: (point.cost(cost), point.errors[error])):
        if not front or point.errors[error] < front[-1].errors[error]:
            front.append(point)
    return front


def order(points: Points, error: str, floor: float) -> Order | None:
    """Order of one curve whose values are steps; None where fewer than two steps have a significant error.

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


def cheapest(points: Points, accuracy: float, error: str, cost: str, *, floor: float = 0.0) -> Point | None:
    """The cheapest point whose error is within the accuracy, uncertainty of the reference added; None if none is."""
    within = [point for point in points if point.measured and point.errors[error] + floor <= accuracy]
    return min(within, key=lambda point: point.cost(cost), default=None)


Pair = tuple[float, float]


def pairs(points: Points, error: str, cost: str, floor: float) -> list[Pair]:
    """(error, cost) of those points of a curve that no other of it beats and whose error is significant."""
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
