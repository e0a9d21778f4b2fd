"""What the paper's statements need to know of a run."""

from dataclasses import dataclass
from pathlib import Path

from analysis.figures import BeadHistory, SpaceTime
from analysis.tracking.leading_waves import Waves, leading_waves
from analysis.tracking.peaks import PeakFinder
from lammps_inputs import Problem, Scene
from workflow.studies.kept_runs import Say, errors, kept_run


@dataclass(frozen=True)
class Measured:
    """What one run of a scene gave.

    Attributes:
        waves: leading pulses.
        velocity_error: bound on the error of its peak velocities, in units of V: for LAMMPS the difference from the
            reference found when it was run, for the reference its certificate.
        arrival_error: the same of arrivals, in units of T.
    """

    problem: Problem
    waves: Waves
    velocity_error: float
    arrival_error: float
    spacetime: SpaceTime
    history: BeadHistory


def measured(scene: Scene, engine: str, folder: Path, bead: int, say: Say) -> Measured:
    """Run a scene, or take the run that an earlier start finished, and measure it.

    Args:
        scene: what to run.
        engine: "lammps" or "reference".
        folder: where run directories are kept.
        bead: whose velocity over time is kept for a figure.
        say: told what is going on.
    """
    directory = kept_run(scene, engine, folder, say)
    problem = directory.problem
    finder, spacetime, history = PeakFinder(first_only=True), SpaceTime(problem), BeadHistory(problem, (bead,))
    for block in directory.blocks():
        for watcher in (finder, spacetime, history):
            watcher.add(block)
    return Measured(problem, leading_waves(finder.result()), *errors(directory), spacetime, history)
