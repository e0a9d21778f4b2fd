"""Measurement of settings in rounds, one run of each per round; Pareto fronts, orders and advice that follow."""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from granchain import RunError
from granchain.parts import Problem, quantity
from workflow.plugins.trade.settings import LAMMPS, REFERENCE, WINDOW, EngineSetting, Interval, Truth


@dataclass
class MeasuredSetting:
    """Errors and times of a setting.

    Attributes:
        setting: the setting.
        errors: largest error by quantity, the same in every call; velocities in V, arrivals in T.
        calls: time of the time loop in each call, in s; the first may load or compile.
        first: time of the first call with its start and the computation of errors, in s.
        left_out: why the setting was not measured; empty where it was.
        pooled: time that the setting shares with others of its method, see `pool`; None where it shares none.
    """

    setting: EngineSetting
    errors: dict[str, float] = field(default_factory=dict)
    calls: list[float] = field(default_factory=list)
    first: float = 0.0
    left_out: str = ""
    pooled: float | None = None

    @property
    def measured(self) -> bool:
        """Whether the setting was measured."""
        return bool(self.calls) and not self.left_out

    @property
    def repeats(self) -> list[float]:
        """Times of the calls after the first, in s, or of the first where it is the only one."""
        return self.calls[1:] or self.calls

    @property
    def seconds(self) -> float:
        """Median of the repeats, in s, or the pooled time."""
        return statistics.median(self.repeats) if self.pooled is None else self.pooled


Points = Sequence[MeasuredSetting]


@dataclass(frozen=True)
class TrialLimits:
    """How often settings are run, and how long that may take.

    Attributes:
        repeats: number of calls after the first.
        longest: largest time of a call, in s; a setting that would take longer is left out.
        budget: time after which nothing is repeated, in s.
        clock: function that returns the time, in s.
    """

    repeats: int = 5
    longest: float = math.inf
    budget: float = math.inf
    clock: Callable[[], float] = time.perf_counter


def measure(
    settings: Sequence[EngineSetting],
    run: Callable[[EngineSetting], float],
    errors: Callable[[EngineSetting], dict[str, float]],
    limits: TrialLimits,
    follow: Callable[[Points, int, int], None] = lambda *_: None,
) -> list[MeasuredSetting]:
    """Run every setting once, for its errors, and then up to ``repeats`` times more, in rounds, for its time.

    Args:
        settings: settings to measure; those of one method in the order of rising effort, if slow ones may be left out.
        run: runs a setting and returns the time of the time loop in s; a `RunError` is noted.
        errors: errors of the previous run, by quantity.
        limits: limits of calls and time.
        follow: called after every call with all points, the calls done or left out, and their total.

    Returns:
        A point for each setting, in their order.
    """
    points = [MeasuredSetting(setting) for setting in settings]
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
            pool(points)
            follow(points, done, total)
    return points


def pool(points: Points) -> None:
    """Let the times of a method rise with the effort, as what is computed does.

    Other work on the machine may make a median larger than that of a setting of more effort. Neighbours for which it
    does share the mean of their medians (pool adjacent violators: Ayer et al., Ann. Math. Stat. 26, 1955), the
    rising times with the least squares of differences from all medians.
    """
    for method in {point.setting.method for point in points if point.setting.by_step}:
        of_method = [point for point in points if point.measured and point.setting.method == method]
        pools: list[list[MeasuredSetting]] = []
        for point in sorted(of_method, key=lambda point: point.setting.effort):
            point.pooled = None
            pools.append([point])
            while len(pools) > 1 and _mean(pools[-2]) >= _mean(pools[-1]):
                pools[-2:] = [pools[-2] + pools[-1]]
        for shared in pools:
            if len(shared) > 1:
                mean = _mean(shared)
                for point in shared:
                    point.pooled = mean


def _mean(points: Points) -> float:
    """Mean of the medians, in s."""
    return statistics.fmean(statistics.median(point.repeats) for point in points)


def _expected(setting: EngineSetting, points: Points) -> float:
    """Estimated time of a setting, in s, in proportion to that of its engine's setting with the next smaller effort."""
    smaller = [
        point
        for point in points
        if point.measured and point.setting.engine == setting.engine and point.setting.effort <= setting.effort
    ]
    nearest = max(smaller, key=lambda point: point.setting.effort, default=None)
    return 0.0 if nearest is None else nearest.first * setting.effort / nearest.setting.effort


# --- what follows -----------------------------------------------------------------------------------------------------

LARGEST = 0.1
"""Error in units of V from which on a point is left out of the regression for an order."""


WELL_ABOVE = 10.0
"""Ratio of an error to the uncertainty of the reference from which on the error is well known."""


@quantity.result
class Order:
    """Measured order of a method: slope of log error over log step."""

    method: str = quantity.declare("engine and scheme", digits="")
    order: float = quantity.declare("slope by regression", digits=".2f")
    standard_error: float = quantity.declare("standard error of the order", "", "two points", digits=".2f")
    low: float = quantity.declare("smallest step of the regression", "time", digits=".4g")
    high: float = quantity.declare("largest step of the regression", "time", digits=".4g")
    points: int = quantity.declare("number of settings", digits="d")


def pareto(points: Points, name: str) -> list[MeasuredSetting]:
    """Pareto front: points that no other beats in both error and time, in the order of rising time."""
    finite = [point for point in points if point.measured and math.isfinite(point.errors[name])]
    front: list[MeasuredSetting] = []
    for point in sorted(finite, key=lambda point: (point.seconds, point.errors[name])):
        if not front or point.errors[name] < front[-1].errors[name]:
            front.append(point)
    return front


def cheapest(points: Points, accuracy: float, floor: float = 0.0) -> MeasuredSetting | None:
    """Fastest point whose error of velocities plus the uncertainty of the reference is within an accuracy, or None."""
    within = [point for point in points if point.measured and point.errors["velocity"] + floor <= accuracy]
    return min(within, key=lambda point: point.seconds, default=None)


def order(points: Points, floor: float) -> Order | None:
    """Order of the velocities of one method whose values are steps; None with fewer than two significant errors.

    Args:
        points: points of the method.
        floor: error in units of V up to which points are left out, as are those with `LARGEST` or more.
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
    """Measurements of a problem so far.

    Attributes:
        problem: problem of the scene, at its own time step.
        truth: the reference run; None before it is computed.
        points: settings of every engine, measured against the reference.
        frames: errors by the time between frames.
        seconds: wall time, in s.
        complete: whether all settings were measured.
        notes: further sentences of the report.
    """

    problem: Problem
    truth: Truth | None = None
    points: Points = ()
    frames: Sequence[Interval] = ()
    seconds: float = 0.0
    complete: bool = False
    notes: list[str] = field(default_factory=list)

    def __repr__(self) -> str:
        measured = sum(point.measured for point in self.points)
        return (
            f"<errors and times of {self.problem.name}: {measured} settings, {len(self.frames)} times between frames>"
        )

    @property
    def comparable(self) -> list[MeasuredSetting]:
        """Measured points whose errors are the largest of all beads."""
        return [point for point in self.points if point.measured and point.setting.method != WINDOW]

    def by_method(self) -> dict[str, list[MeasuredSetting]]:
        """Points of each method."""
        methods = dict.fromkeys(point.setting.method for point in self.points)
        return {name: [point for point in self.points if point.setting.method == name] for name in methods}

    def front(self, name: str) -> list[MeasuredSetting]:
        """The Pareto front of the error of a quantity and wall time."""
        return pareto(self.comparable, name)

    def orders(self) -> list[Order]:
        """Orders of the methods that have one."""
        if self.truth is None:
            return []
        floor = WELL_ABOVE * self.truth.floors["velocity"]
        stepped = (points for points in self.by_method().values() if points[0].setting.by_step)
        return [measured_order for points in stepped if (measured_order := order(points, floor)) is not None]


# --- advice: which setting for which accuracy, and what else is worth choosing ----------------------------------------

ACCURACIES = (1e-2, 1e-4, 1e-6, 1e-8)


def sentences(study: Findings) -> list[str]:
    """Results of the study, one sentence a line."""
    if study.truth is None:
        return list(study.notes)
    lines = [uncertainty(study.truth)]
    lines += left_out(study) + late_order(study)
    lines += [advice(study, study.truth, accuracy) for accuracy in ACCURACIES]
    return lines + suzuki(study) + study.notes


def uncertainty(truth: Truth) -> str:
    """Sentence on the uncertainty of the reference, and on the errors that are well above it."""
    floor = truth.floors["velocity"]
    return (
        f"Uncertainty of the reference: {floor:.1e} V and {truth.floors['arrival']:.1e} T; errors of velocities below "
        f"{WELL_ABOVE * floor:.1e} V are not well known."
    )


def left_out(study: Findings) -> list[str]:
    """Sentences on settings that were not measured, and why, one for each method."""
    lines = []
    for name, several in study.by_method().items():
        if points := [point for point in several if point.left_out]:
            more = f", and {len(points) - 1} more" if len(points) > 1 else ""
            lines.append(f"Left out: {name}, {points[0].setting.label} ({points[0].left_out}){more}.")
    return lines


def late_order(study: Findings) -> list[str]:
    """Sentence on the order of small steps, where a measured one is larger."""
    if not any(measured.order > FINAL_ORDER for measured in study.orders()):
        return []
    return [
        "Where a contact of spheres opens or closes, the second derivative of its force is unbounded: for small steps "
        f"velocities have an error of order {FINAL_ORDER:g}, also by the reference, a scheme of order 4; orders "
        "measured over larger steps lie between the two."
    ]


FINAL_ORDER = 2.5
"""Order 1 + p of velocities for small steps, of contacts of exponent p = 3/2, whatever the order of the scheme."""


def advice(study: Findings, truth: Truth, accuracy: float) -> str:
    """Sentence on the fastest engine and setting within an accuracy of all velocities, and on the fastest in LAMMPS."""
    points = study.comparable
    if not points:
        return f"{accuracy:.0e}: nothing was measured."
    of_lammps = [point for point in points if point.setting.method != REFERENCE]
    best, lammps = (cheapest(group, accuracy, truth.floors["velocity"]) for group in (points, of_lammps))
    if best is None:
        return f"{accuracy:.0e}: nothing measured reaches it; the nearest is {_says(_nearest(points), study.problem)}."
    sentence = f"{accuracy:.0e}: {_says(best, study.problem)}"
    if lammps is best or not of_lammps:
        return f"{sentence}."
    if lammps is None:
        nearest = _says(_nearest(of_lammps), study.problem)
        return f"{sentence}; no measured time step of LAMMPS reaches it, the nearest is {nearest}."
    return f"{sentence}; with LAMMPS {_says(lammps, study.problem)}."


def _nearest(points: list[MeasuredSetting]) -> MeasuredSetting:
    return min(points, key=lambda point: point.errors["velocity"])


def _says(point: MeasuredSetting, problem: Problem) -> str:
    """A setting as a user would ask for it, its error, and its cost."""
    problem_of_point, scale, ranks = point.setting.problem, problem.scale, point.setting.ranks
    step = f"{_dividing(problem_of_point.timestep * scale.time, problem_of_point.steps_per_frame)}"
    if point.setting.method == REFERENCE:
        how = f"{REFERENCE} at a step of {step}{scale.after('time')}"
    else:
        scheme = "" if problem_of_point.scheme == "verlet" else f"scheme: {problem_of_point.scheme}, "
        how = f"`{scheme}timestep: {step}`{scale.after('time')}" + (f" on {ranks} ranks" if ranks > 1 else "")
    if problem_of_point.every > problem.every * (1.0 + 1e-9):
        how += f" and frames {problem_of_point.every * scale.time:.6g} apart"
    return f"{how} ({point.errors['velocity']:.1e} V, {point.seconds:.2g} s)"


def _dividing(step: float, count: int) -> str:
    """A time step in as few digits as divide the time between frames well enough for a scene."""
    if count == 1:
        return f"{step:.6g}"
    texts = (f"{step:.{digits}g}" for digits in range(2, 17))
    return next((text for text in texts if abs(float(text) / step - 1.0) < 5e-10), repr(step))


def suzuki(study: Findings) -> list[str]:
    """Sentence on the error below which suzuki4 is faster than Verlet in LAMMPS, by interpolation of the latter."""
    several = study.by_method()
    verlet, suzuki4 = (pareto(several.get(LAMMPS + name, []), "velocity") for name in ("verlet", "suzuki4"))
    x, y = (np.log([(point.errors["velocity"], point.seconds) for point in verlet[::-1]] or [(1.0, 1.0)])).T
    common = [point for point in suzuki4 if x[0] <= math.log(point.errors["velocity"]) <= x[-1]]
    if not common:
        return []
    faster = [math.log(point.seconds) < np.interp(math.log(point.errors["velocity"]), x, y) for point in common]
    count = [*faster[::-1], False].index(False)
    if count:
        words = f"beats Verlet from an error of {common[-count].errors['velocity']:.1e} V on"
    else:
        least = common[-1].errors["velocity"]
        words = f"does not beat Verlet down to an error of {least:.1e} V, the least that both reach here"
    return [f"In LAMMPS suzuki4 {words}, for the {study.problem.chains * study.problem.beads} beads of this scene."]
