"""Lyapunov exponents of a scene, and for how long its run can be predicted.

Four runs of the reference carry tangent vectors: from the scene's start and from one nearby, each with the usual time
step and with half of it. Exponents are their mean, if they agree.

| file            | contents                                                                    |
|-----------------|-----------------------------------------------------------------------------|
| exponents.csv   | a line for each exponent, with its uncertainty                              |
| runs.csv        | the exponents of each run                                                   |
| convergence.csv | the largest exponent of each run up to a time                               |
| lyapunov.png    | the convergence, and with several exponents all of them                     |
| cases.jsonl     | the cache of runs                                                           |
"""

import argparse
import itertools
import math
import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from granchain import InputError
from granchain.parts import (
    DEFAULT_ACCURACY,
    Floats,
    Problem,
    Study,
    computations,
    library,
    options,
    panels,
    quantity,
    screen,
    units,
)
from workflow.plugins.derivatives import tangent
from workflow.plugins.lyapunov import growth

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TABLE, RUNS, CONVERGENCE, FIGURE = "exponents.csv", "runs.csv", "convergence.csv", "lyapunov"
STUDY = Study(
    "lyapunov",
    f"{TABLE} is the table",
    tables=(TABLE, RUNS, CONVERGENCE),
    figures=(FIGURE,),
    cache="cases.jsonl",
)

DURATION = 10_000.0
"""Default duration of a run, in units of T."""

REFINEMENTS, STARTS = (1, 2), (0, 1)

LEAST_GROWTH = 10.0
"""Logarithm of the least growth along a run that counts as exponential; that of regular motion is that of time."""

LEAST_UNCERTAINTIES = 3.0
"""Least size of an exponent, over its uncertainty, that can be distinguished from 0."""

AGREEMENT = 16.3
"""Largest sum of squares of the runs' deviations from their mean over their uncertainties: exceeded by 1 in 1000 of
four independent runs."""

ROUNDING = 2.0**-53
"""Relative error of a rounded number in double precision."""


@quantity.result
class Exponent:
    """A Lyapunov exponent; the first is the largest."""

    number: int = quantity.declare("number of the exponent, in descending order", digits="d")
    exponent: float | None = quantity.declare(
        "mean rate of growth of the logarithm of a deviation, mean over the runs",
        "rate",
        "it cannot be distinguished from 0, or the runs differ by more than their uncertainties",
        digits=".4g",
    )
    uncertainty: float | None = quantity.declare(
        "standard error, from blocks of each run", "rate", "the exponent is undefined", digits=".1e"
    )
    bound: float | None = quantity.declare(
        "bound on the size of an exponent that cannot be distinguished from 0: below 10 over the duration, or within "
        "three uncertainties",
        "rate",
        "the exponent can be distinguished from 0, or the runs differ by more than their uncertainties",
        digits=".2g",
    )


@quantity.result
class RunExponent:
    """An exponent of one run."""

    step: float = quantity.declare("time step of the reference", "time", digits=".4g")
    start: int = quantity.declare("0: start of the scene; 1: a start nearby", digits="d")
    number: int = quantity.declare("number of the exponent, in descending order", digits="d")
    exponent: float | None = quantity.declare(
        "mean rate of growth of the logarithm of a deviation",
        "rate",
        "that of the four runs cannot be distinguished from 0",
        digits=".4g",
    )
    uncertainty: float | None = quantity.declare(
        "standard error, from blocks of the run", "rate", "the exponent is undefined", digits=".1e"
    )


@quantity.result
class RunningEstimate:
    """The largest exponent of one run up to a time."""

    step: float = quantity.declare("time step of the reference", "time")
    start: int = quantity.declare("0: start of the scene; 1: a start nearby")
    time: float = quantity.declare("time since the start", "time")
    exponent: float = quantity.declare("growth of the logarithm of the deviation until then, over the time", "rate")


@dataclass(frozen=True)
class GrowthOfRun:
    """Growth of deviations along one run.

    Attributes:
        refinement: steps in a usual one.
        start: 0 for the scene's start, 1 for one nearby.
        time: [record], in units of T.
        growth: logarithm since the start, [record, exponent].
    """

    refinement: int
    start: int
    time: Floats
    growth: Floats


@dataclass(frozen=True)
class LyapunovResult:
    """Exponents of a scene, dimensionless.

    Attributes:
        problem: the scene's problem.
        runs: growth along the runs.
        exponents: all exponents.
        duration: of a run, in units of T.
        accuracy: accuracy that is asked of runs of the scene, in units of V.
    """

    problem: Problem
    runs: list[GrowthOfRun]
    exponents: list[Exponent]
    duration: float
    accuracy: float

    def __repr__(self) -> str:
        return f"<Lyapunov exponents of {self.problem.name}: {self.sentences()[0]}>"

    @property
    def chaotic(self) -> bool:
        """Whether deviations grow exponentially."""
        largest = self.exponents[0].exponent
        return largest is not None and largest > 0.0

    def predictable(self, deviation: float) -> tuple[float, float] | None:
        """Time in units of T until a rounding error has grown to a deviation in V, and its uncertainty.

        None where deviations do not grow exponentially.
        """
        largest = self.exponents[0]
        if not self.chaotic or largest.exponent is None or largest.uncertainty is None:
            return None
        duration = math.log(deviation / ROUNDING) / largest.exponent
        return duration, duration * largest.uncertainty / largest.exponent

    def sentences(self) -> list[str]:
        """What follows, in sentences."""
        scale, largest = self.problem.scale, self.exponents[0]
        if largest.bound is not None:
            bound = scale.written(largest.bound, "rate", ".2g")
            subject = "no positive exponent" if any(line.bound is None for line in self.exponents) else "no exponent"
            return [f"{subject} can be distinguished from 0: the largest is below {bound} in size"]
        if largest.exponent is None or largest.uncertainty is None:
            rates = [growth.exponents_of(run.time, run.growth)[0][0] for run in self.runs]
            texts = ", ".join(scale.written(rate, "rate", ".4g") for rate in rates)
            return [f"the largest exponent is undefined: the runs differ ({texts}); try a longer `--duration`"]
        value, error = (scale.measured(number, "rate") for number in (largest.exponent, largest.uncertainty))
        unit = " 1/s" if scale.si else " per unit time"
        lines = [f"the largest Lyapunov exponent is {value:.4g} +- {error:.1g}{unit}"]
        if not self.chaotic:
            return [*lines, "deviations decay: a run can be predicted for any time"]
        for deviation, words in ((1.0, "the velocity V"), (self.accuracy, f"an accuracy of {self.accuracy:g} V")):
            until, error = self.predictable(deviation) or (math.nan, math.nan)
            lines.append(
                f"rounding errors in double precision reach {words} after {scale.written(until, 'time', '.4g')} "
                f"+- {scale.written(error, 'time', '.1g')}"
            )
        return lines

    def plain(self) -> dict[str, Any]:
        """Plain data of the result in the scene's units, for scripts."""
        scale = self.problem.scale
        until = self.predictable(1.0)
        return {
            "exponents": quantity.plain(self.exponents, scale),
            "chaotic": self.chaotic,
            "predictable": None if until is None else scale.measured(until[0], "time"),
        }


# --- carried out ------------------------------------------------------------------------------------------------------


def study(scene: dict[str, Any], source: str, directory: Path, exponents: int, duration: float) -> LyapunovResult:
    """Compute exponents on all cores; runs of an earlier start are not computed again.

    Args:
        scene: plain data of the scene.
        source: its name in messages.
        directory: made if need be.
        exponents: number of exponents.
        duration: of each run, in units of T.

    Raises:
        InputError: the scene cannot be linearised, or the directory cannot be used.
        RunError: a process was killed.
    """
    problem = tangent.problem_of(scene, source)
    plans = list(itertools.product(REFINEMENTS, STARTS))
    with STUDY.evaluating(directory) as values:
        answers = values([_case(scene, source, exponents, *plan, duration) for plan in plans])
        runs = [
            GrowthOfRun(*plan, np.array(answer["time"]), np.array(answer["growth"]))
            for plan, answer in zip(plans, answers, strict=True)
        ]
        accuracy = scene.get("accuracy") or DEFAULT_ACCURACY
        spectrum = LyapunovResult(problem, runs, combined(runs), duration, accuracy)
        tables: dict[str, Any] = {
            TABLE: (Exponent, spectrum.exponents),
            RUNS: (RunExponent, _of_runs(spectrum)),
            CONVERGENCE: (RunningEstimate, _estimates(spectrum)),
        }
        STUDY.write(directory, tables, {FIGURE: _figure(spectrum)}, problem.scale)
    return spectrum


def duration_of(problem: Problem, exponents: int, duration: float | None) -> float:
    """Duration of each run, in units of T.

    Args:
        problem: problem of the scene.
        exponents: number of exponents.
        duration: in the scene's units; None for the default.

    Raises:
        InputError: it is too short, or there are not so many exponents.
    """
    chosen = DURATION if duration is None else duration / problem.scale.time
    least = growth.RECORDS * growth.STEPS_PER_INTERVAL * growth.usual_step(problem)
    if duration is not None and chosen < least:
        shortest = problem.scale.written(least, "time", ".3g")
        raise InputError(f"--duration: {duration:g} given; at least {shortest}, for {growth.RECORDS} records")
    available = 2 * int(np.sum(tangent.make_flow(problem, 0, 1.0).free))
    if exponents > available:
        raise InputError(f"--exponents: {exponents} given; the scene has {available}, two for each free bead")
    return chosen


def _case(
    scene: dict[str, Any], source: str, exponents: int, refinement: int, start: int, duration: float
) -> computations.Computation:
    arguments = {
        "plain": scene,
        "source": source,
        "exponents": exponents,
        "refinement": refinement,
        "start": start,
        "duration": duration,
    }
    return computations.case("workflow.plugins.lyapunov.growth:computed", arguments, cost=float(refinement))


def combined(runs: list[GrowthOfRun]) -> list[Exponent]:
    """Means of the exponents of runs, where these agree; bounds where they cannot be distinguished from 0."""
    both = [growth.exponents_of(run.time, run.growth) for run in runs]
    values, errors = (np.array(part) for part in zip(*both, strict=True))
    least = LEAST_GROWTH / min(float(run.time[-1]) for run in runs)
    exponents = []
    for number, (value, error) in enumerate(zip(values.T, errors.T, strict=True), 1):
        mean, uncertainty = float(np.mean(value)), float(np.sqrt(np.sum(error**2))) / len(runs)
        apart = np.sum((value - mean) ** 2 / np.maximum(error, 1e-12) ** 2)
        largest = float(np.max(np.abs(value) + LEAST_UNCERTAINTIES * error))
        if bool(np.all(np.abs(value) < least)) or (
            apart <= AGREEMENT and abs(mean) <= LEAST_UNCERTAINTIES * uncertainty
        ):
            exponents.append(Exponent(number, None, None, max(least, largest)))
        elif apart <= AGREEMENT:
            exponents.append(Exponent(number, mean, uncertainty, None))
        else:
            exponents.append(Exponent(number, None, None, None))
    return exponents


def _of_runs(spectrum: LyapunovResult) -> list[RunExponent]:
    usual, lines = growth.usual_step(spectrum.problem), []
    for run in spectrum.runs:
        pairs = zip(*(part.tolist() for part in growth.exponents_of(run.time, run.growth)), strict=True)
        for exponent, pair in zip(spectrum.exponents, pairs, strict=True):
            value, error = pair if exponent.bound is None else (None, None)
            lines.append(RunExponent(usual / run.refinement, run.start, exponent.number, value, error))
    return lines


def _estimates(spectrum: LyapunovResult) -> list[RunningEstimate]:
    usual = growth.usual_step(spectrum.problem)
    return [
        RunningEstimate(usual / run.refinement, run.start, float(until), float(total / until))
        for run in spectrum.runs
        for until, total in zip(run.time, run.growth[:, 0], strict=True)
    ]


def _figure(spectrum: LyapunovResult) -> "Figure":
    from workflow.plugins.lyapunov import figure

    scale, usual = spectrum.problem.scale, growth.usual_step(spectrum.problem)
    lines = []
    for run in spectrum.runs:
        step = scale.written(usual / run.refinement, "time", ".3g")
        name = f"step {step}, start {'nearby' if run.start else 'of the scene'}"
        exponent = scale.measured(run.growth[:, 0] / run.time, "rate")
        lines.append(figure.Convergence(name, scale.measured(run.time, "time"), exponent))
    results = [(exponent.exponent, exponent.uncertainty, exponent.bound) for exponent in spectrum.exponents]
    values, errors, bounds = (
        scale.measured(np.array([math.nan if number is None else number for number in part]), "rate")
        for part in zip(*results, strict=True)
    )
    unit = units.Label("exponent", r"\lambda", scale.symbol("rate")), units.Label("time", "t", scale.symbol("time"))
    return figure.draw(lines, values, errors, bounds, unit, panels.title(spectrum.problem))


def seconds(problem: Problem, exponents: int, duration: float) -> float:
    """Estimated time of the runs on all cores, in s, from that of some steps; compiles the program."""
    flow = tangent.make_flow(problem, exponents, growth.usual_step(problem))
    flow.advance(0, 1)
    started = time.perf_counter()
    flow.advance(1, growth.STEPS_PER_INTERVAL)
    of_step = (time.perf_counter() - started) / growth.STEPS_PER_INTERVAL
    steps = len(STARTS) * sum(REFINEMENTS) * duration / flow.step
    return steps * of_step / min(os.cpu_count() or 1, len(STARTS) * len(REFINEMENTS))


# --- command ----------------------------------------------------------------------------------------------------------

ANSWERS = "the exponents, and for how long a run can be predicted"
DRAWS = True
EXAMPLES = (
    "lyapunov magnets -o chaos",
    "lyapunov scene.yaml --exponents 24 --duration 5e4 -o chaos",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("scene", metavar="SCENE", help="the scene; its own end, time step and output do not matter")
    parser.add_argument(
        "--exponents",
        metavar="N",
        type=options.within(int, 1, 10_000),
        default=1,
        help="number of exponents, the largest first (default 1)",
    )
    parser.add_argument(
        "--duration",
        metavar="TIME",
        type=options.within(float, 0.0, 1e300),
        help=f"duration of a run in the scene's units (default {DURATION:g} T)",
    )
    options.add_output(parser)


def execute(arguments: argparse.Namespace) -> screen.CommandResult:
    """Print the exponents; exit code 1 where runs differ in the largest, 130 when interrupted, with all runs kept."""
    name = arguments.scene
    scene = library.find(name)
    plain_scene = scene.plain()
    problem = tangent.problem_of(plain_scene, name)
    duration = duration_of(problem, arguments.exponents, arguments.duration)
    screen.print_heading(scene.name, scene.units)
    print(f"four runs are computed, in about {seconds(problem, arguments.exponents, duration):.2g} s")
    try:
        spectrum = study(plain_scene, name, arguments.output, arguments.exponents, duration)
    except KeyboardInterrupt:
        return options.interrupted()
    if len(spectrum.exponents) > 1:
        STUDY.print_records("exponents", Exponent, spectrum.exponents, problem.scale)
    for line in spectrum.sentences():
        print(line)
    screen.print_files(arguments.output, (TABLE, RUNS, CONVERGENCE, *STUDY.figure_files))
    largest = spectrum.exponents[0]
    return screen.CommandResult(1 if largest.exponent is None and largest.bound is None else 0, spectrum.plain())
