"""The true error of a run, by a reference that is finer than the one the run was checked with.

Every frame of every bead is compared. Where the reference would take too long for that, what is left is the leading
pulse, which a window finds, and the invariants: they prove an error of at least so much.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from analysis.against.common_times import paired
from analysis.against.difference import Difference
from analysis.conservation import Conservation
from analysis.tracking.leading_waves import Waves, leading_waves
from analysis.tracking.peaks import THRESHOLD, PeakFinder
from lammps_inputs import Problem, physics
from workflow.engines.reference import engine
from workflow.engines.reference.certify import Certifier
from workflow.engines.reference.passages import passages, usual_timestep
from workflow.engines.reference.schemes import BLANES_MOAN
from workflow.runs.run_directory import RunDirectory

LONGEST = 8.0
"""Seconds that a comparison may take, as estimated."""

_BEAD_STAGE = 1.5e-9
_STAGE = 20e-9
"""Seconds of the reference's kernel for a stage of a bead, and of a step beyond its beads."""

_HALVINGS = 4
_WINDOW = 160
_CLEAR = 2.0 * THRESHOLD
_SLOPE = 0.826
"""Steepest slope of a solitary wave's velocity over its peak to the power 1.2: what is late by a time is off by this
times it."""


@dataclass(frozen=True)
class TrueError:
    """What the judge found: the largest error, how sure that is (units of V), and how it was found."""

    error: float
    sure: float
    by: str


def judge(directory: RunDirectory, tolerance: float, *, longest: float = LONGEST) -> TrueError:
    """The largest error of any velocity.

    Args:
        directory: a run that came to its end.
        tolerance: how sure to be, in units of V, as far as the time allows.
        longest: seconds that one comparison may take.
    """
    problem = replace(directory.problem, window=None)  # all rows, whatever the run had
    steps = 2 * engine.default_steps_per_frame(problem)
    if _seconds(problem, steps) > longest:
        return _by_leading_pulse(directory)
    for _ in range(_HALVINGS):
        truth = _by_reference(directory, problem, steps)
        if truth.sure <= tolerance or _seconds(problem, 2 * steps) > longest:
            break
        steps *= 2
    return truth


def _seconds(problem: Problem, steps_per_frame: int) -> float:
    """About what two reference runs side by side take, one with half the steps; a pulse passes a bead in T or so."""
    kicked = [bead for _, bead, _ in physics.excitations(problem.system)]
    rows = min(problem.beads, max(kicked) - min(kicked) + 1 + 0.5 * problem.duration)
    steps = 1.5 * problem.frames * steps_per_frame
    return steps * BLANES_MOAN.forces_per_step * (rows * problem.chains * _BEAD_STAGE + _STAGE)


def _by_reference(directory: RunDirectory, problem: Problem, steps_per_frame: int) -> TrueError:
    certifier = Certifier(problem, steps_per_frame=steps_per_frame)
    difference = Difference(dict.fromkeys(("velocity", "displacement", "amplitude", "arrival"), math.inf))
    references = (replace(block, problem=directory.problem) for block in certifier.blocks())
    for block, reference in paired(directory.blocks(), references):
        difference.add(block, reference)
    return TrueError(difference.deviations()["velocity"].largest, certifier.certificate.velocity, "reference")


def _by_leading_pulse(directory: RunDirectory) -> TrueError:
    problem = replace(directory.problem, window=None)
    finder, conservation = PeakFinder(first_only=True), Conservation()
    for block in directory.blocks():
        finder.add(block)
        conservation.add(block)
    own = leading_waves(finder.result())
    right = [_passages(problem, refinement) for refinement in (2.0, 1.0)]
    invariants = (conservation.energy_drift / 2.0, conservation.momentum_drift)  # NaN where not all is recorded
    error = float(np.nanmax([_apart(own, right[0]), *invariants]))
    return TrueError(error, 3.0 * _apart(*right), "leading pulse")


def _passages(problem: Problem, refinement: float) -> Waves:
    kicked = [bead for _, bead, _ in physics.excitations(problem.system)]
    window = min(problem.beads + 30, max(kicked) - min(kicked) + _WINDOW)
    return passages(problem, window=window, timestep=usual_timestep(problem) / refinement).waves


def _apart(one: Waves, other: Waves) -> float:
    """Largest difference of two leading pulses, as one of velocities; inf if they have no bead in common.

    Left out, as in `analysis.against.difference.matched`, are the foremost bead, which may fly off, and the smallest
    pulses.
    """
    place = [
        {
            (int(c), int(b)): k
            for k, (c, b, v) in enumerate(zip(w.chain, w.bead, w.peak_velocity, strict=True))
            if v > _CLEAR
        }
        for w in (one, other)
    ]
    both = sorted(place[0].keys() & place[1].keys())
    foremost = max((bead for _, bead in both), default=0)
    i, j = ([known[key] for key in both if key[1] < foremost] for known in place)
    late = _SLOPE * one.peak_velocity[i] ** 1.2 * np.abs(one.arrival[i] - other.arrival[j])
    peaks = np.abs(one.peak_velocity[i] - other.peak_velocity[j])
    return float(np.max(np.fmax(peaks, late), initial=0.0)) if i else math.inf
