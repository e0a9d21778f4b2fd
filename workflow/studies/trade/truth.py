"""What errors are measured against: the accurate_reference reference, with the scene's frames, on the disk."""

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.against.common_times import paired
from analysis.against.difference import matched
from analysis.files import recording
from analysis.tracking.peaks import THRESHOLD, PeakFinder, Peaks, sharp
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from workflow.engines.reference import engine
from workflow.engines.reference.step_halving import StepHalving, Uncertainty

QUANTITIES = ("velocity", "amplitude", "arrival")

GOAL = 1e-10
"""Uncertainty of velocities beyond which the reference is not refined."""

REFINEMENT = 4

Errors = dict[str, float]
Floats = NDArray[np.float64]


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
    def floors(self) -> Errors:
        """By quantity, how wrong the reference itself may be."""
        found = self.uncertainty
        return {"velocity": found.velocity, "amplitude": found.velocity, "arrival": found.arrival}

    def errors(self, blocks: Iterable[Trajectory]) -> Errors:
        """Largest errors of a run whose frames are among this problem's; its passages are found in the same frames.

        Of a window, only the rows count that `analysis.against.common_times.near_the_front` takes to be right.
        """
        stream = iter(blocks)
        first = next(stream)
        stride = max(1, round(first.problem.every / self.problem.every))
        own = replace(self.problem, window=first.problem.window)
        reference = recording.blocks([self.path], self.problem, stride)
        return deviation(chain([first], stream), (replace(block, problem=own) for block in reference))


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
        write(path, problem, halving.blocks())
        found = Truth(problem, path, halving.uncertainty, time.perf_counter() - started)
        if found.uncertainty.velocity <= GOAL or REFINEMENT * found.seconds > seconds:
            return found
        steps = REFINEMENT * halving.steps_per_frame


def write(path: Path, problem: Problem, blocks: Iterable[Trajectory]) -> None:
    """Write frames as LAMMPS does."""
    step = 0
    with recording.Writer(path, problem) as writer:
        for block in blocks:
            for state in block.states():
                writer.append(step, *state)
                step += problem.steps_per_frame


def deviation(blocks: Iterable[Trajectory], reference: Iterable[Trajectory], peaks: Peaks | None = None) -> Errors:
    """Largest error of velocities, and of the leading pulse's amplitudes and arrivals; infinite for a run gone bad.

    A passage of the reference that the run does not show has an error of its own amplitude, and an infinite arrival.

    Args:
        blocks: the run.
        reference: the same frames by the reference.
        peaks: its first passages, if they are known better than these frames show them.
    """
    finders = PeakFinder(first_only=True), PeakFinder(first_only=True)
    velocity, last, every, beads = 0.0, 0.0, 0.0, 0
    with np.errstate(over="ignore", invalid="ignore"):  # of a run that blew up
        for own, other in paired(blocks, reference):
            finders[0].add(own)
            if peaks is None:
                finders[1].add(other)
            velocity = max(velocity, _largest(own.velocity - other.velocity))
            last, every, beads = float(own.time[-1]), own.problem.every, own.problem.beads
        if not math.isfinite(velocity):
            return dict.fromkeys(QUANTITIES, math.inf)
        found = finders[0].result()
    true = finders[1].result() if peaks is None else peaks
    missed = _missed(found, true, last - 2.0 * every)
    found, true = matched(found, true, beads)
    amplitude = max(_largest(found.velocity - true.velocity), float(missed.velocity.max(initial=0.0)))
    arrival = math.inf if len(missed) else _largest((found.time - true.time)[sharp(true)])
    return {"velocity": velocity, "amplitude": amplitude, "arrival": arrival}


def _missed(found: Peaks, true: Peaks, until: float) -> Peaks:
    """Clear passages before some time at beads where nothing was found."""
    keys = [peaks.chain * 2**40 + peaks.bead for peaks in (found, true)]
    way = true.direction * true.bead
    clear = (true.velocity > 2.0 * THRESHOLD) & (way < way.max(initial=-(2**40))) & (true.time < until)
    return true.where(clear & ~np.isin(keys[1], keys[0]))


def _largest(values: Floats) -> float:
    """Largest size; infinite if one is not a number."""
    size = float(np.max(np.abs(values), initial=0.0))
    return size if math.isfinite(size) else math.inf
