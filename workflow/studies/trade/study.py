"""Error against cost of everything that can be chosen for a scene, measured on this machine, written as it comes.

| file       | what                                                                                             |
|------------|--------------------------------------------------------------------------------------------------|
| trade.csv  | a row for each setting: its errors against the reference, and its times                          |
| frames.csv | a row for each time between frames: errors of amplitudes and arrivals that are read from them    |
| trade.json | both with every repeat, the advice, orders of convergence and Pareto fronts                      |
| trade.png  | the work-precision figure                                                                        |
"""

import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.files import recording
from analysis.tracking.peaks import PeakFinder
from lammps_inputs import Problem, Scene
from workflow.engines.lammps import mpi
from workflow.errors import RunError
from workflow.prepare.settings import settle
from workflow.runs.files import as_json
from workflow.runs.own_files import prepared
from workflow.runs.run_directory import provenance
from workflow.studies.study import Study, csv_text
from workflow.studies.trade import settings, work_precision
from workflow.studies.trade.truth import QUANTITIES, Truth, deviation, make_truth
from workflow.studies.trade.work_precision import Limits, Point, Points, pareto

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENGINES, FRAMES, REPORT, FIGURE = "trade.csv", "frames.csv", "trade.json", "trade"
STUDY = Study(
    "trade",
    f"{REPORT} holds what was found",
    tables=(ENGINES, FRAMES, REPORT),
    figures=(FIGURE,),
    resume="its tables hold what was measured; take another -o",
)

BUDGET = 60.0
"""Seconds that a study should take; what would take much of it alone is left out."""

REPEATS = 5

_TRUTH, _ENGINES, _LONGEST, _PATIENCE = 1 / 4, 1 / 2, 1 / 15, 1 / 30
"""Shares of the budget: of the reference, of all engines, of one run, of all runs of a setting."""

BUSY = 0.7
"""Load, before anything is run, that makes times unreliable."""

WELL_ABOVE = 10.0
"""Errors over the uncertainty of the reference from which on they are known."""

FORCE_SECONDS = 1e-9
"""Of a bead, by the reference."""

Follow = Callable[[int, int], None]
"""Called with the calls done, and an upper bound of all calls."""


@dataclass(frozen=True)
class Interval:
    """What is lost between frames: largest errors of amplitudes and arrivals that are read from them.

    Attributes:
        every: time between frames, in units of T.
        amplitude_error, arrival_error: in units of V and T.
        bytes: of all frames.
    """

    every: float
    amplitude_error: float
    arrival_error: float
    bytes: float


@dataclass
class Findings:
    """What has been measured of a problem so far.

    Attributes:
        problem: of the scene, at its own time step.
        truth: the reference; None before it is known.
        engines: points of every engine, against the reference.
        frames: of one run of LAMMPS, by the time between frames.
        seconds: wall time.
        whole: whether it came to its end.
        notes: what else is to be said.
    """

    problem: Problem
    truth: Truth | None = None
    engines: Points = ()
    frames: Sequence[Interval] = ()
    seconds: float = 0.0
    whole: bool = False
    notes: list[str] = field(default_factory=list)

    @property
    def comparable(self) -> list[Point]:
        """Measured points whose errors are those of all beads."""
        return [point for point in self.engines if point.measured and settings.is_whole(point.setting.curve)]

    def front(self, quantity: str) -> list[Point]:
        """The Pareto front of the error of a quantity and wall time."""
        return pareto(self.comparable, quantity, "seconds")

    @property
    def curves(self) -> dict[str, list[Point]]:
        """Points by method."""
        names = dict.fromkeys(point.setting.curve for point in self.engines)
        return {name: [point for point in self.engines if point.setting.curve == name] for name in names}

    def orders(self) -> dict[str, dict[str, work_precision.Order | None]]:
        """Curve and quantity -> order."""
        floors = {} if self.truth is None else self.truth.floors
        return {
            name: {
                quantity: work_precision.order(points, quantity, WELL_ABOVE * floor)
                for quantity, floor in floors.items()
            }
            for name, points in self.curves.items()
            if floors and settings.has_order(name)
        }


# --- measurements -----------------------------------------------------------------------------------------------------


def plain_problem(scene: Scene) -> Problem:
    """A scene with its own end and time step, but without the window and the scheme, which are measured.

    Raises:
        InputError: the scene has no end or an unstable time step.
    """
    step = scene.timestep if scene.scheme in (None, "verlet") else None
    return settle(scene.model_copy(update={"window": None, "scheme": None, "timestep": step}))[0].problem()


def expected(problem: Problem) -> tuple[float, float]:
    """A rough guess of the seconds that the reference takes, and the bytes of one run's frames."""
    # two runs of six force evaluations a step, half of the rows moving
    steps = problem.duration / min(0.05, problem.every)
    return FORCE_SECONDS * 9.0 * steps * problem.chains * problem.beads, _size(problem)


def _size(problem: Problem) -> float:
    return 24.0 * problem.frames * problem.chains * len(problem.recorded_beads)


def busy() -> list[str]:
    """What to say of a machine that has other work to do."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if load < BUSY:
        return []
    return [
        f"Other work was under way (load {load:.1f} on {mpi.cores()} cores): times are no better than their spread."
    ]


def study(
    problem: Problem,
    directory: Path,
    *,
    budget: float = BUDGET,
    repeats: int = REPEATS,
    follow: Follow = lambda *_: None,
) -> Findings:
    """Measure everything, or until Ctrl-C; ``trade.csv`` grows as it goes.

    Args:
        problem: of a scene.
        directory: new or empty.
        budget: seconds that it should take.
        repeats: calls of a setting after its first.
        follow: called after every call.

    Raises:
        InputError: the directory holds something.
        RunError: the reference or LAMMPS failed altogether.
    """
    with prepared(directory):
        STUDY.mark(directory, done=False)
        found = Findings(problem, notes=busy())
        started = time.perf_counter()
        try:
            with tempfile.TemporaryDirectory(prefix=".running-", dir=directory) as name:
                _measure(found, directory, Path(name), budget, repeats, follow)
            found.whole = True
        except KeyboardInterrupt:
            found.notes.append("Interrupted: not all settings were measured.")
        found.seconds = time.perf_counter() - started
    return found


def _measure(found: Findings, directory: Path, work: Path, budget: float, repeats: int, follow: Follow) -> None:
    problem = found.problem
    follow(0, 1)
    truth = found.truth = make_truth(problem, work, seconds=_TRUTH * budget)
    limits = Limits(repeats, _LONGEST * budget, _PATIENCE * budget, _ENGINES * budget)

    def keep(points: Points, done: int, total: int) -> None:
        found.engines = points
        STUDY.write(directory, {ENGINES: engines_csv(points, problem)})
        follow(done, total)

    work_precision.measure(
        settings.settings(problem),
        lambda job: settings.run(job, work),
        lambda done: truth.errors(done.blocks()),
        lambda done: done.costs,
        limits,
        keep,
    )
    if not any(point.measured and point.setting.what.problem == problem for point in found.engines):
        found.notes.append("Frames were not measured: a run at the scene's time step takes too long.")
        return
    try:
        found.frames = intervals(problem, work)
    except RunError as error:
        found.notes.append(f"Frames were not measured: {error}.")
        return
    every = problem.scale.heading("every", "time")
    rows = [{every: one.every * problem.scale.time, **vars(one)} for one in found.frames]
    head = [every, *(name for name in rows[0] if name not in (every, "every"))]
    STUDY.write(directory, {FRAMES: csv_text(rows, head)})


FARTHEST = 2.0
"""Time between frames from which on a wave falls between them."""

LEAST_FRAMES = 10

NEAR = 0.025
"""Time between the frames in which passages are taken to be found exactly: to 1e-9 of T and of V."""

MOST_BYTES = 400_000_000


def intervals(problem: Problem, directory: Path) -> list[Interval]:
    """What other times between frames than the scene's show, from one run of LAMMPS that is recorded often.

    Raises:
        RunError: LAMMPS failed.
    """
    finer = _finer(problem)
    fine = _recorded(problem, finer[0])
    dump = settings.run(settings.Job("lammps", fine), directory).dump
    finder = PeakFinder(first_only=True)
    for block in recording.blocks([dump], fine):
        finder.add(block)
    exact, found = finder.result(), []
    counts = {problem.steps_per_frame * 2**power for power in range(8)}
    while len(finer) > 1:
        counts.add(finer[-1])
        finer = [count for count in finer if count <= finer[-1] // 2]
    for count in sorted(counts, reverse=True):
        own, stride = _recorded(problem, count), count // fine.steps_per_frame
        if own.every > FARTHEST or own.frames < LEAST_FRAMES:
            continue
        run = [(replace(block, problem=own) for block in recording.blocks([dump], fine, stride)) for _ in range(2)]
        errors = deviation(run[0], run[1], exact)
        found.append(Interval(own.every, errors["amplitude"], errors["arrival"], _size(own)))
    return found


def _finer(problem: Problem) -> list[int]:
    """Steps from frame to frame, ascending, that record a run more often than the scene: the least is exact enough."""
    steps = problem.steps_per_frame
    fit = [n for n in range(1, steps + 1) if steps % n == 0 and _size(_recorded(problem, n)) <= MOST_BYTES]
    least = max((n for n in fit if n * problem.timestep <= NEAR), default=min(fit, default=steps))
    return [n for n in fit if n % least == 0 and n < steps] or [steps]


def _recorded(problem: Problem, steps: int) -> Problem:
    """The same run with a frame every so many steps."""
    return replace(problem, steps_per_frame=steps, frames=problem.steps // steps)


# --- report -----------------------------------------------------------------------------------------------------------


def engines_csv(points: Points, problem: Problem) -> str:
    """A row for each setting; errors in units of V and T, ``timestep`` and ``every`` in the scene's.

    ``seconds`` is the median of the repeats, or the first call where ``repeats`` is 0; ``start`` is not in it. Columns
    are empty where nothing was measured.
    """
    scale, rows = problem.scale, []
    for point in points:
        job, seconds = point.setting.what, point.costs("seconds") if point.measured else []
        rows.append(
            {
                "method": point.setting.curve,
                "setting": point.setting.label,
                scale.heading("timestep", "time"): job.problem.timestep * scale.time,
                scale.heading("every", "time"): job.problem.every * scale.time,
                "ranks": job.ranks,
                "window": job.window or job.problem.window,
                **{f"{name}_error": point.errors.get(name) for name in QUANTITIES},
                **{name: point.cost(name) if point.measured else None for name in ("forces", "seconds")},
                "seconds_min": min(seconds, default=None),
                "seconds_max": max(seconds, default=None),
                "seconds_first": point.first.get("seconds"),
                "repeats": len(point.repeats) if point.measured else None,
                "start": point.cost("start") if point.measured else None,
                "note": point.left_out,
            }
        )
    return csv_text(rows)


def write(found: Findings, directory: Path, advice: Sequence[str]) -> None:
    """Write ``trade.json`` and the figure, and mark the directory as finished where everything was measured."""
    figures = {FIGURE: _figure(found, found.truth)} if found.truth is not None and found.comparable else {}
    STUDY.write(directory, {REPORT: as_json(plain(found, advice)) + "\n"}, figures)
    if found.whole:
        STUDY.mark(directory, done=True)


def plain(found: Findings, advice: Sequence[str]) -> dict[str, Any]:
    """The contents of ``trade.json``; errors and steps dimensionless."""
    truth = found.truth
    return {
        "scene": found.problem.name,
        "whole": found.whole,
        "seconds": found.seconds,
        "advice": list(advice),
        "reference": None if truth is None else {**asdict(truth.uncertainty), "seconds": truth.seconds},
        "orders": {
            name: {quantity: None if order is None else asdict(order) for quantity, order in by.items()}
            for name, by in found.orders().items()
        },
        "pareto": {
            quantity: [f"{point.setting.curve}, {point.setting.label}" for point in found.front(quantity)]
            for quantity in (() if truth is None else QUANTITIES)
        },
        "engines": [
            {
                "method": point.setting.curve,
                "setting": point.setting.label,
                "value": point.setting.value,
                "errors": point.errors,
                "first": point.first,
                "repeats": point.repeats,
                "left_out": point.left_out,
            }
            for point in found.engines
        ],
        "frames": [asdict(one) for one in found.frames],
        **provenance(),
    }


def _figure(found: Findings, truth: Truth) -> "Figure":
    from analysis.figures.work_precision import Curve, work_precision_figure  # matplotlib takes a while to import

    drawn = []
    for name, several in found.curves.items():
        points = [point for point in several if point.measured]
        seconds = [point.costs("seconds") for point in points]
        if points:
            drawn.append(
                Curve(
                    name=name if settings.is_whole(name) else f"{name} (near the front)",
                    error={quantity: np.array([point.errors[quantity] for point in points]) for quantity in QUANTITIES},
                    seconds=np.array([point.cost("seconds") for point in points]),
                    low=np.array([min(each) for each in seconds]),
                    high=np.array([max(each) for each in seconds]),
                    forces=np.array([point.cost("forces") for point in points]),
                )
            )
    fronts = {
        quantity: np.array([(point.cost("seconds"), point.errors[quantity]) for point in found.front(quantity)])
        for quantity in QUANTITIES
    }
    return work_precision_figure(found.problem, drawn, fronts, truth.floors)
