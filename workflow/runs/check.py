"""The error of a run, measured when it has ended, by the reference at some of its frames.

Also the references that a run is compared with, or is: with ever more steps until their uncertainty is as asked for.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from analysis.compare.difference import Deviation, DeviationPlace, Uncertainty, errors_of
from analysis.tracking.peak_bounds import quickness_of
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, physics
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import StepHalving
from workflow.prepare.pilot import CADENCE, SPACING, stride
from workflow.prepare.step_choice import ChosenStep, ReferenceFrames
from workflow.runs.completed_run import Check
from workflow.runs.run_directory import RunDirectory

UNCERTAINTY_PART = 1.0 / 3.0
"""Largest uncertainty of the reference, as a part of the accuracy that is checked with it."""

_MOST_DOUBLINGS = 4

CLOSED = 1e-9
"""Largest deviation of the energy budget of a run by the reference, over the energy input."""

_MOST_STEPS = 256
"""Largest number of steps in place of a usual one, to close the budget."""


def references_of(problem: Problem, settings: ChosenStep | None) -> Iterator[StepHalving]:
    """References of a problem, of which the last counts; the uncertainty of each is read when its blocks were taken.

    With an accuracy in ever more steps, until the uncertainty is small enough or falls hardly more. Without one, or
    where nothing could be measured for the default, the usual reference.
    """
    if settings is None or (settings.measured == 0.0 and not settings.asked):
        yield StepHalving(problem)
        return
    steps = 2 * math.ceil(0.5 * problem.every / settings.reference_timestep * (1.0 - 1e-9))
    before = math.inf
    for _ in range(_MOST_DOUBLINGS):
        halving = StepHalving(problem, steps_per_frame=steps)
        yield halving
        uncertainty = halving.uncertainty.velocity
        if uncertainty <= UNCERTAINTY_PART * settings.accuracy or uncertainty > 0.5 * before:
            return
        before, steps = uncertainty, 2 * steps


def closing(problem: Problem) -> Iterator[StepHalving]:
    """The usual reference; where energy is exchanged with ever more steps, until the budget is closed."""
    halving = StepHalving(problem)
    yield halving
    usual = halving.uncertainty.steps_per_frame
    while physics.exchanges(problem.system) and (missing := halving.uncertainty.energy) > CLOSED:
        steps = halving.uncertainty.steps_per_frame
        # contacts that open and close leave an order of 2.5
        steps = min(math.ceil(1.5 * steps * (missing / CLOSED) ** 0.4), _MOST_STEPS * usual)
        if steps <= halving.uncertainty.steps_per_frame:
            return
        halving = StepHalving(problem, steps_per_frame=steps)
        yield halving


LITTLE = 100_000
"""Number of recorded states of beads up to which all are compared; that takes some hundredths of a second."""


def stored_check(directory: RunDirectory) -> Check | None:
    """Error of a run that was measured at its end, from ``run.json``; None where that holds none."""
    record = directory.account.check
    if record is None:
        return None
    where = None if record.where is None else DeviationPlace.from_plain(**record.where.plain())
    numbers: dict[str, Any] = {
        name: math.nan if value is None else value for name, value in record.reference.model_dump().items()
    }
    velocity, arrival, amplitude = (
        math.nan if value is None else value for value in (record.velocity, record.arrival, record.amplitude)
    )
    return Check(velocity, where, arrival, amplitude, Uncertainty(**numbers), record.seconds)


def check(directory: RunDirectory, settings: ChosenStep | None = None) -> Check:
    """Compare a run with an accurate reference.

    Args:
        directory: the run.
        settings: how the time step was chosen, if for an accuracy: the uncertainty of the reference is then a fraction
            of that, and the frames are compared as closely spaced as by the pilot run, whose reference serves again.

    Returns:
        The measured error, with the uncertainty of the reference.

    Raises:
        InputError: the run has no frames.
    """
    engine.load()  # takes its time once in a process, whatever is checked
    started = time.perf_counter()
    problem = directory.problem
    little = problem.frames * problem.chains * len(problem.rows.numbers) <= LITTLE
    spacing = SPACING / quickness_of(problem.system) if settings is None else CADENCE
    step = 1 if little else stride(problem, spacing)
    deviations, uncertainty = _compared(problem.coarser(step), lambda: directory.blocks(step), settings)
    velocity = deviations["velocity"]
    amplitude, arrival = (
        deviations[name].largest if name in deviations else math.nan for name in ("amplitude", "arrival")
    )
    return Check(
        velocity=velocity.largest,
        where=velocity.where,
        arrival=arrival,
        amplitude=amplitude,
        reference=uncertainty,
        seconds=time.perf_counter() - started,
    )


def _compared(
    problem: Problem, frames: Callable[[], Iterator[Trajectory]], settings: ChosenStep | None
) -> tuple[dict[str, Deviation], Uncertainty]:
    """Error of the frames in each quantity, and the uncertainty of the reference."""
    for halving in _references(problem, settings):
        deviations = errors_of(frames(), halving.blocks())
    return deviations, halving.uncertainty


def _references(problem: Problem, settings: ChosenStep | None) -> Iterable[StepHalving | ReferenceFrames]:
    """The pilot run's reference where it has the same frames, else new ones."""
    from_pilot = None if settings is None else settings.reference
    return (
        (from_pilot.of(problem),)
        if from_pilot is not None and from_pilot.is_of(problem)
        else references_of(problem, settings)
    )
