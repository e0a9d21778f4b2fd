"""Measure error against cost on this machine: time steps, schemes, ranks, windows, frames.

The table of settings is written after each measurement.

| file       | contents                                                                                         |
|------------|--------------------------------------------------------------------------------------------------|
| trade.csv  | a row for each measured setting: its errors against the reference, and its times                 |
| frames.csv | a row for each time between frames: errors of amplitudes and arrivals that are read from them    |
| trade.json | both with the advice and orders of convergence                                                    |
| trade.png  | the work-precision figure                                                                        |
"""

import argparse
import math
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from granchain import InputError, Scene
from granchain.parts import Problem, Study, file_names, library, mpi, quantity, recording, screen, settle
from workflow.plugins.trade.points import Findings, Order, Points, TrialLimits, measure, sentences
from workflow.plugins.trade.settings import QUANTITIES, WINDOW, Interval, Truth, intervals, make_truth, run, settings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ENGINES, FRAMES, REPORT, FIGURE = "trade.csv", "frames.csv", "trade.json", "trade"
STUDY = Study(
    "trade",
    f"{REPORT} holds what was found",
    tables=(ENGINES, FRAMES, REPORT),
    figures=(FIGURE,),
    resume="its tables hold what was measured; the same command measures again",
)

BUDGET = 60.0
"""Approximate duration of a study, in s; settings that would take a large share of it are left out."""

REPEATS = 5
"""Number of calls of a setting after its first."""

_TRUTH, _ENGINES, _LONGEST = 1 / 4, 1 / 2, 1 / 15
"""Shares of the budget: of the reference, of all engines, of one run."""

BUSY = 0.7
"""Load, before anything is run, that makes times unreliable."""


@quantity.result
class PrintedSetting:
    """A measured setting as it is printed and written."""

    method: str = quantity.declare("engine and scheme, or what varies", digits="")
    setting: str = quantity.declare("value of what varies", digits="")
    timestep: float = quantity.declare("time step", "time")
    every: float = quantity.declare("time between frames", "time")
    velocity_error: float = quantity.declare("largest error of a velocity", "V", digits=".1e", head="velocity")
    amplitude_error: float = quantity.declare(
        "largest error of a peak velocity of the leading pulse", "V", digits=".1e", head="amplitude"
    )
    arrival_error: float = quantity.declare(
        "largest error of an arrival of the leading pulse", "T", digits=".1e", head="arrival"
    )
    forces: int = quantity.declare("number of evaluations of all forces", digits=".3g")
    seconds: float = quantity.declare(
        "median time of the time loop with its frames, without the first call; where it falls as a method's "
        "evaluations of forces rise, the mean of the medians that do",
        "s",
        digits=".3g",
        head="s",
    )
    seconds_min: float = quantity.declare("least time of the time loop, or that median", "s", digits=".2g", head="min")
    seconds_max: float = quantity.declare(
        "largest time of the time loop, or that median", "s", digits=".2g", head="max"
    )
    first: float = quantity.declare("time of the first call with its start", "s", digits=".2g")
    front: str = quantity.declare("* on the Pareto front of the velocities' error and time", digits="")


def records(findings: Findings) -> list[PrintedSetting]:
    """Records of all settings that were measured."""
    front = findings.front("velocity")
    return [
        PrintedSetting(
            method=point.setting.method,
            setting=point.setting.label,
            timestep=point.setting.problem.timestep,
            every=point.setting.problem.every,
            **{f"{name}_error": point.errors[name] for name in QUANTITIES},
            forces=point.setting.forces,
            seconds=point.seconds,
            seconds_min=min(*point.repeats, point.seconds),
            seconds_max=max(*point.repeats, point.seconds),
            first=point.first,
            front="*" if any(point is front_point for front_point in front) else "",
        )
        for point in findings.points
        if point.measured
    ]


# --- measurements -----------------------------------------------------------------------------------------------------


def plain_problem(scene: Scene) -> Problem:
    """Problem of a scene with its own end and time step, but without the window and the scheme, which are measured.

    Raises:
        InputError: the scene has no end or an unstable time step.
    """
    step = scene.timestep if scene.scheme in (None, "verlet") else None
    return settle(scene.model_copy(update={"window": None, "scheme": None, "timestep": step}))[0].problem()


def busy() -> list[str]:
    """Sentences for the report where the machine has other work to do."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if load < BUSY:
        return []
    return [f"Other processes ran (load {load:.1f} on {mpi.cores()} cores): times are no better than their spread."]


def study(problem: Problem, directory: Path, *, budget: float = BUDGET) -> Findings:
    """Measure everything, or until Ctrl-C, and write it; ``trade.csv`` grows meanwhile.

    Args:
        problem: problem of a scene.
        directory: made if need be, or that of an earlier study.
        budget: approximate duration, in s.

    Raises:
        InputError: the directory cannot be used.
        RunError: the reference failed.
    """
    findings = Findings(problem, notes=busy())
    started = time.perf_counter()
    with STUDY.opened(directory), screen.count_bar("trade") as follow:
        try:
            with tempfile.TemporaryDirectory(prefix=".running-", dir=directory) as name:
                _measure(
                    findings, directory, Path(name), TrialLimits(REPEATS, _LONGEST * budget, _ENGINES * budget), follow
                )
            findings.complete = True
        except KeyboardInterrupt:
            findings.notes.append("Interrupted: not all settings were measured.")
        findings.seconds = time.perf_counter() - started
        _write(findings, directory)
    STUDY.mark(directory, done=findings.complete)
    return findings


def _measure(findings: Findings, directory: Path, work: Path, limits: TrialLimits, follow: Callable[..., None]) -> None:
    problem = findings.problem
    follow(0, 1)
    truth = findings.truth = make_truth(problem, work, seconds=_TRUTH / _ENGINES * limits.budget)

    def keep(points: Points, done: int, total: int) -> None:
        findings.points = points
        STUDY.write(directory, {ENGINES: (PrintedSetting, records(findings))}, scale=problem.scale)
        follow(done, total)

    measure(
        settings(problem),
        lambda setting: run(setting, work),
        lambda setting: truth.errors(recording.blocks([work / file_names.DUMP], setting.problem)),
        limits,
        keep,
    )
    findings.frames = intervals(problem)
    STUDY.write(directory, {FRAMES: (Interval, findings.frames)}, scale=problem.scale)


# --- report -----------------------------------------------------------------------------------------------------------


def _write(findings: Findings, directory: Path) -> None:
    """Write ``trade.json`` and the figure."""
    figures = {FIGURE: _figure(findings, findings.truth)} if findings.truth is not None and findings.comparable else {}
    STUDY.write(directory, {REPORT: report(findings)}, figures)


def report(findings: Findings) -> dict[str, Any]:
    """Contents of ``trade.json``; times in the scene's units, errors in V and T."""
    truth, scale = findings.truth, findings.problem.scale
    contents = {
        "scene": findings.problem.name,
        "whole": findings.complete,
        "seconds": findings.seconds,
        "advice": sentences(findings),
        "reference": None if truth is None else {**asdict(truth.uncertainty), "seconds": truth.seconds},
        "orders": quantity.plain(findings.orders(), scale),
        "engines": quantity.plain(records(findings), scale),
        "frames": quantity.plain(findings.frames, scale),
    }
    return STUDY.with_provenance(contents)


def _figure(findings: Findings, truth: Truth) -> "Figure":
    from workflow.plugins.trade.figure import work_precision_figure  # matplotlib takes a while to import

    methods: dict[str, list[dict[str, Any]]] = {}
    for record in records(findings):
        name = f"{record.method} (near the front)" if record.method == WINDOW else record.method
        methods.setdefault(name, []).append(vars(record))
    fronts = {
        name: np.array([(point.seconds, point.errors[name]) for point in findings.front(name)]) for name in QUANTITIES
    }
    return work_precision_figure(findings.problem, methods, fronts, truth.floors)


# --- command ----------------------------------------------------------------------------------------------------------

DRAWS = True
EXAMPLES = (
    "trade two-chains -o trade",
    "trade my/scene.yaml -o trade --budget 120   # seconds",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="a YAML file, or the name of an installed scene")
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory to make")
    parser.add_argument(
        "--budget",
        metavar="SECONDS",
        type=float,
        default=BUDGET,
        help=f"about how long it may take; runs that would take much of it are left out (default {BUDGET:g})",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print tables and sentences; write two tables, a report and a figure."""
    if not (math.isfinite(arguments.budget) and arguments.budget > 0.0):
        raise InputError(f"--budget: {arguments.budget:g} given; a number of seconds above 0")
    scene = library.find(arguments.scene)
    problem = plain_problem(scene)
    screen.print_heading(scene.name, scene.units)
    findings = study(problem, arguments.output, budget=arguments.budget)
    _print(findings)
    names = [name for name in STUDY.files if (arguments.output / name).exists()]
    screen.print_files(arguments.output, names)
    if not findings.complete:
        raise KeyboardInterrupt
    return 0


def _print(findings: Findings) -> None:
    scale = findings.problem.scale
    title = "largest errors (V, V, T), wall time (s) of the time loop with its frames; steps in T"
    tables = (
        (title, PrintedSetting, records(findings)),
        ("measured orders, of velocities", Order, findings.orders()),
        ("errors of amplitudes (V) and arrivals (T), by the time between frames", Interval, findings.frames),
    )
    for title, kind, found_of in tables:
        STUDY.print_records(title, kind, found_of, scale)
    for sentence in sentences(findings):
        print(sentence)
