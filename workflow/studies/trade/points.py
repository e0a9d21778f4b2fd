"""Settings measured in rounds that take each in turn, and what follows from the points: Pareto fronts and orders."""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from analysis.quantity import declare, result
from lammps_inputs import Problem
from workflow.errors import RunError
from workflow.studies.trade.settings import WINDOW, Setting
from workflow.studies.trade.truth import Interval, Truth


@dataclass
class Point:
    """What a setting was found to do.

    Attributes:
        errors: largest, by quantity; the same in every call.
        calls: seconds of the time loop in each call; the first may load or compile.
        first: seconds of the first call with its start and the computation of errors.
        left_out: why there are no numbers; empty where there are.
    """

    setting: Setting
    errors: dict[str, float] = field(default_factory=dict)
    calls: list[float] = field(default_factory=list)
    first: float = 0.0
    left_out: str = ""

    @property
    def measured(self) -> bool:
        """Whether there are numbers."""
        return bool(self.calls) and not self.left_out

    @property
    def repeats(self) -> list[float]:
        """Seconds of the calls after the first, or of that where it is the only one."""
        return self.calls[1:] or self.calls

    @property
    def seconds(self) -> float:
        """Their median."""
        return statistics.median(self.repeats)


Points = Sequence[Point]


@dataclass(frozen=True)
class Limits:
    """How often settings are run, and how long that may take.

    Attributes:
        repeats: calls after the first.
        longest: seconds that one call may take; a setting that would take longer is left out.
        budget: seconds after which nothing is repeated.
        clock: seconds.
    """

    repeats: int = 5
    longest: float = math.inf
    budget: float = math.inf
    clock: Callable[[], float] = time.perf_counter


def measure(
    settings: Sequence[Setting],
    run: Callable[[Setting], float],
    errors: Callable[[Setting], dict[str, float]],
    limits: Limits,
    follow: Callable[[Points, int, int], None] = lambda *_: None,
) -> list[Point]:
    """Run every setting once, for its errors, and then up to ``repeats`` times more, in rounds, for its time.

    Args:
        settings: those of one method in the order of rising effort, if some are to be left out.
        run: seconds of the time loop; `RunError` where it fails, which is noted.
        errors: of the run before.
        limits: of calls and time.
        follow: called after every call with all points, the calls done or left out, and their total.

    Returns:
        a point for each setting, in their order.
    """
    points = [Point(setting) for setting in settings]
    clock, done, total = limits.clock, 0, len(points) * (1 + limits.repeats)
    begun = clock()
    for number in range(1 + limits.repeats):
        for point in points:
            try:
                if number > 0:
                    if point.measured and clock() - begun <= limits.budget:
                        point.calls.append(run(point.setting))
                elif (expected := _expected(point.setting, points)) > limits.longest:
                    point.left_out = f"would take {expected:.2g} s"
                else:
                    started, seconds = clock(), run(point.setting)
                    point.errors = errors(point.setting)
                    point.calls, point.first = [seconds], clock() - started
            except RunError as error:
                point.left_out = str(error)
            done += 1
            follow(points, done, total)
    return points


def _expected(setting: Setting, points: Points) -> float:
    """Seconds of a setting at most: in proportion to those of its engine's setting with the next smaller effort."""
    smaller = [
        point
        for point in points
        if point.measured and point.setting.engine == setting.engine and point.setting.effort <= setting.effort
    ]
    nearest = max(smaller, key=lambda point: point.setting.effort, default=None)
    return 0.0 if nearest is None else nearest.first * setting.effort / nearest.setting.effort


# --- what follows -----------------------------------------------------------------------------------------------------

LARGEST = 0.1
"""Errors from here on say nothing about an order."""


WELL_ABOVE = 10.0
"""Errors over the uncertainty of the reference from which on they are known."""


@result
class Order:
    """Slope of log error over log step."""

    method: str = declare("engine and scheme", digits="")
    order: float = declare("slope by regression", digits=".2f")
    standard_error: float = declare("of the order", "", "two points", digits=".2f")
    low: float = declare("smallest step of the regression", "time", digits=".4g")
    high: float = declare("largest step of the regression", "time", digits=".4g")
    points: int = declare("number of settings", digits="d")


def pareto(points: Points, quantity: str) -> list[Point]:
    """The points that no other beats in both error and time, in the order of rising time."""
    known = [point for point in points if point.measured and math.isfinite(point.errors[quantity])]
    front: list[Point] = []
    for point in sorted(known, key=lambda point: (point.seconds, point.errors[quantity])):
        if not front or point.errors[quantity] < front[-1].errors[quantity]:
            front.append(point)
    return front


def cheapest(points: Points, accuracy: float, floor: float = 0.0) -> Point | None:
    """The fastest point whose velocities are within the accuracy, the uncertainty of the reference added; or None."""
    within = [point for point in points if point.measured and point.errors["velocity"] + floor <= accuracy]
    return min(within, key=lambda point: point.seconds, default=None)


def order(points: Points, floor: float) -> Order | None:
    """Order of the velocities of one method whose values are steps; None with fewer than two significant errors.

    Args:
        points: of the method.
        floor: errors that are not above it are left out, as are those not below `LARGEST`.
    """
    significant = [point for point in points if point.measured and floor < point.errors["velocity"] < LARGEST]
    steps = np.array([point.setting.value for point in significant])
    if len(np.unique(steps)) < 2:
        return None
    x, y = np.log(steps), np.log([point.errors["velocity"] for point in significant])
    if len(x) == 2:
        slope, spread = np.polyfit(x, y, 1)[0], math.nan
    else:
        (slope, _), covariance = np.polyfit(x, y, 1, cov=True)
        spread = math.sqrt(covariance[0, 0])
    method = significant[0].setting.method
    return Order(method, float(slope), spread, float(steps.min()), float(steps.max()), len(x))


@dataclass
class Findings:
    """What has been measured of a problem so far.

    Attributes:
        problem: of the scene, at its own time step.
        truth: the reference; None before it is known.
        points: of every engine, against the reference.
        frames: errors by the time between frames.
        seconds: wall time.
        whole: whether it came to its end.
        notes: what else is to be said.
    """

    problem: Problem
    truth: Truth | None = None
    points: Points = ()
    frames: Sequence[Interval] = ()
    seconds: float = 0.0
    whole: bool = False
    notes: list[str] = field(default_factory=list)

    @property
    def comparable(self) -> list[Point]:
        """Measured points whose errors are those of all beads."""
        return [point for point in self.points if point.measured and point.setting.method != WINDOW]

    def by_method(self) -> dict[str, list[Point]]:
        """Points of each method."""
        methods = dict.fromkeys(point.setting.method for point in self.points)
        return {name: [point for point in self.points if point.setting.method == name] for name in methods}

    def front(self, quantity: str) -> list[Point]:
        """The Pareto front of the error of a quantity and wall time."""
        return pareto(self.comparable, quantity)

    def orders(self) -> list[Order]:
        """Of each method that has one."""
        if self.truth is None:
            return []
        floor = WELL_ABOVE * self.truth.floors["velocity"]
        found = [order(points, floor) for points in self.by_method().values() if points[0].setting.by_step]
        return [one for one in found if one is not None]
