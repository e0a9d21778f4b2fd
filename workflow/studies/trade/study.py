"""Error against cost of everything that can be chosen for a scene, measured on this machine, written as it comes."""

import os
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from lammps_inputs import Problem, Scene
from workflow.engines.lammps import mpi
from workflow.errors import RunError
from workflow.prepare.settings import settle
from workflow.runs.own_files import prepared
from workflow.studies.study import Study, csv_text
from workflow.studies.trade import frames, grid, jobs, work_precision
from workflow.studies.trade.certified import QUANTITIES, Certified, make_truth
from workflow.studies.trade.jobs import Size
from workflow.studies.trade.work_precision import Limits, Point

# --- tables -----------------------------------------------------------------------------------------------------------

ENGINES, FRAMES = "trade.csv", "frames.csv"

Points = Sequence[Point[Any]]


def engines_csv(points: Points, problem: Problem) -> str:
    """A row for each setting; errors in units of V and T, ``timestep`` and ``every`` in the scene's.

    ``seconds`` is the median of the repeats, or the first call where ``repeats`` is 0; ``start`` is not in it.
    """
    scale = problem.scale

    def own(job: jobs.Job) -> dict[str, Any]:
        return {
            scale.heading("timestep", "time"): job.problem.timestep * scale.time,
            scale.heading("every", "time"): job.problem.every * scale.time,
            "ranks": job.ranks,
            "window": job.window or job.problem.window,
        }

    return csv_text([_row(point, own(point.setting.what), ("forces",)) for point in points])


def frames_csv(points: Points, problem: Problem) -> str:
    """A row for each way to record; errors of reading alone; ``seconds`` is running and reading."""
    every = problem.scale.heading("every", "time")

    def own(job: frames.Recording) -> dict[str, Any]:
        return {every: job.problem.every * problem.scale.time, "format": job.format}

    return csv_text([_row(point, own(point.setting.what), ("bytes", "run", "read")) for point in points])


def _row(point: Point[Any], own: dict[str, Any], costs: Sequence[str]) -> dict[str, Any]:
    """The columns of a point; None where it was not measured."""
    seconds = point.costs("seconds") if point.measured else []
    return {
        "method": point.setting.curve,
        "setting": point.setting.label,
        **own,
        **{f"{name}_error": point.errors.get(name) for name in QUANTITIES},
        **{name: point.cost(name) if point.measured else None for name in (*costs, "seconds")},
        "seconds_min": min(seconds, default=None),
        "seconds_max": max(seconds, default=None),
        "seconds_first": point.first.get("seconds"),
        "repeats": len(point.repeats) if point.measured else None,
        "start": point.cost("start") if "start" in point.first else None,
        "note": point.left_out,
    }


# --- study ------------------------------------------------------------------------------------------------------------

REPORT, FIGURE = "trade.json", "trade"
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

_TRUTH, _ENGINES, _FRAMES, _LONGEST, _PATIENCE = 1 / 4, 1 / 2, 1 / 6, 1 / 15, 1 / 30
"""Shares of the budget: of the reference, of all engines, of all recordings, of one run, of all runs of a setting."""

BUSY = 0.7
"""Load, before anything is run, that makes times unsure."""

FORCE_SECONDS = 1e-9
"""Of a bead, by the reference."""

Follow = Callable[[str, int, int], None]
"""Called with what is being done, the calls done, and an upper bound of all calls."""


@dataclass
class Findings:
    """What has been measured of a problem so far.

    Attributes:
        problem: of the scene, at its own time step.
        truth: the reference; None before it is known.
        engines: points of every engine, against the reference.
        frames: points of recording and reading, against the same run read exactly.
        sizes: cost of a step in LAMMPS by beads.
        seconds: wall time.
        whole: whether it came to its end.
    """

    problem: Problem
    truth: Certified | None = None
    engines: Points = ()
    frames: Points = ()
    sizes: Sequence[Size] = ()
    seconds: float = 0.0
    whole: bool = False
    notes: list[str] = field(default_factory=list)


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
    seconds = FORCE_SECONDS * 9.0 * steps * problem.chains * problem.beads
    return seconds, 24.0 * problem.frames * problem.chains * len(problem.recorded_beads)


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
    """Measure everything, or until Ctrl-C; ``trade.csv`` and ``frames.csv`` grow as it goes.

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
    follow("reference", 0, 1)
    truth = make_truth(problem, work, seconds=_TRUTH * budget)
    found.truth = truth
    limits = Limits(repeats, _LONGEST * budget, _PATIENCE * budget)

    def keep_engines(points: Points, done: int, total: int) -> None:
        found.engines = points
        STUDY.write(directory, {ENGINES: engines_csv(points, problem)})
        follow("engines", done, total)

    def keep_frames(points: Points, done: int, total: int) -> None:
        found.frames = points
        STUDY.write(directory, {FRAMES: frames_csv(points, problem)})
        follow("frames", done, total)

    work_precision.measure(
        grid.settings(problem),
        lambda job: jobs.run(job, work),
        lambda done: truth.errors(done.blocks()),
        jobs.Done.costs,
        limits,
        keep_engines,
    )
    if not any(point.measured and point.setting.what.problem == problem for point in found.engines):
        found.notes.append("Frames and sizes were not measured: a run at the scene's time step takes too long.")
        return
    try:
        exact = frames.make_exact(problem, work)
        work_precision.measure(
            frames.settings(problem),
            lambda job: frames.run(job, work),
            exact.errors,
            frames.Read.costs,
            replace(limits, budget=_FRAMES * budget),
            keep_frames,
        )
        follow("sizes", 0, 1)
        found.sizes = jobs.step_costs(problem, work)
    except RunError as error:
        found.notes.append(f"Frames and sizes were not measured: {error}.")
