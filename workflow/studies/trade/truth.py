"""What errors are measured against: an accurate reference with the scene's frames, on the disk."""

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

import numpy as np

from analysis.against.difference import errors_of, matched
from analysis.files import recording
from analysis.quantity import declare, result
from analysis.tracking.leading_waves import leading_finder, leading_passages
from analysis.tracking.peaks import PeakFinder, Peaks, sharp
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import StepHalving, Uncertainty
from workflow.runs.engines import write_frames
from workflow.studies.trade.settings import LEAST_FRAMES

QUANTITIES = ("velocity", "amplitude", "arrival")

GOAL = 1e-10
"""Uncertainty of velocities beyond which the reference is not refined."""

REFINEMENT = 4


@dataclass(frozen=True)
class Truth:
    """The reference run of a problem.

    Attributes:
        problem: with the scene's frames.
        path: its frames.
        uncertainty: of its velocities and arrivals.
        seconds: wall time of the run that was kept.
    """

    problem: Problem
    path: Path
    uncertainty: Uncertainty
    seconds: float

    @property
    def floors(self) -> dict[str, float]:
        """Uncertainty of each quantity."""
        found = self.uncertainty
        return {"velocity": found.velocity, "amplitude": found.velocity, "arrival": found.arrival}

    def errors(self, blocks: Iterable[Trajectory]) -> dict[str, float]:
        """Largest errors of a run whose frames are among this problem's; infinite where they are undefined.

        Of a window, only the rows count that `analysis.against.common_times.near_the_front` takes to be right.
        """
        stream = iter(blocks)
        first = next(stream)
        stride = max(1, round(first.problem.every / self.problem.every))
        own = replace(self.problem, window=first.problem.window)
        reference = recording.blocks([self.path], self.problem, stride)
        found = errors_of(chain([first], stream), (replace(block, problem=own) for block in reference))
        sizes = {name: found[name].largest if name in found else math.inf for name in QUANTITIES}
        return {name: size if math.isfinite(size) else math.inf for name, size in sizes.items()}


def make_truth(problem: Problem, directory: Path, *, seconds: float) -> Truth:
    """Refine the reference until its uncertainty is below `GOAL`, or the next refinement would take too long.

    Args:
        problem: with the scene's frames.
        directory: for its frames.
        seconds: wall time that the last refinement may take.
    """
    path, steps = directory / "reference.bin", None
    engine.run(replace(problem, frames=1))  # compiles what it takes
    while True:
        started = time.perf_counter()
        halving = StepHalving(problem, steps_per_frame=steps)
        if write_frames(path, problem, halving.blocks())["outcome"] != "done":
            raise KeyboardInterrupt
        found = Truth(problem, path, halving.uncertainty, time.perf_counter() - started)
        if found.uncertainty.velocity <= GOAL or REFINEMENT * found.seconds > seconds:
            return found
        steps = REFINEMENT * halving.steps_per_frame


# --- frames -----------------------------------------------------------------------------------------------------------

NEAR = 0.025
"""Time between frames (T) at which passages are taken to be exact: to 1e-9 of T and of V."""

FARTHEST = 2.0
"""Time between frames (T) from which on a wave falls between them."""


@result
class Interval:
    """Largest errors of the leading pulse that are due to the time between frames."""

    every: float = declare("time between frames", "time", digits=".4g")
    amplitude_error: float = declare("largest error of a peak velocity", "V", "a peak is missed", digits=".1e")
    arrival_error: float = declare("largest error of an arrival", "T", "a peak is missed", digits=".1e")
    megabytes: float = declare("size of all frames", "MB", digits=".3g")


def intervals(problem: Problem) -> list[Interval]:
    """Errors of amplitudes (V) and arrivals (T) read from other frames than the scene's, and the size of all frames."""
    halvings = max(1, math.ceil(math.log2(problem.every / NEAR)))
    step = problem.every / 2**halvings
    fine = replace(problem, timestep=step, steps_per_frame=1, frames=problem.frames * 2**halvings)
    most = min(math.log2(FARTHEST / step), math.log2(fine.frames / LEAST_FRAMES))
    seldom = [fine.coarser(2**power) for power in range(1 + max(0, math.floor(most)))]
    exact, *others = _passages(fine, seldom)
    return [_interval(own, found, exact) for own, found in zip(seldom[1:], others, strict=True)][::-1]


def _passages(fine: Problem, seldom: list[Problem]) -> Iterator[Peaks]:
    """The leading pulse at each bead, as several frequencies of frames show it."""
    finders: list[PeakFinder] = [leading_finder(own) for own in seldom]
    done = 0
    for block in engine.blocks(fine):
        for own, finder in zip(seldom, finders, strict=True):
            part = block[-done % own.steps_per_frame :: own.steps_per_frame]
            if part.frames:
                finder.add(replace(part, problem=own))
        done += block.frames
    return (leading_passages(finder.result(), own).first() for finder, own in zip(finders, seldom, strict=True))


def _interval(own: Problem, found: Peaks, exact: Peaks) -> Interval:
    """Errors of what was found; infinite where a passage is missing that does not end with the run."""
    early = exact.where(exact.time < own.duration - 2.0 * own.every)
    missing = len(matched(found, early, own.beads)[0]) < len(matched(early, early, own.beads)[0])
    found, true = matched(found, exact, own.beads)
    amplitude = float(np.max(np.abs(found.velocity - true.velocity), initial=math.inf if missing else 0.0))
    arrival = float(np.max(np.abs(found.time - true.time)[sharp(true)], initial=math.inf if missing else 0.0))
    return Interval(own.every, amplitude, arrival, 24e-6 * own.frames * own.chains * len(own.recorded_beads))
