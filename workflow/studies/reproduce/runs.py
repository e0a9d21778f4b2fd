"""The runs a report needs, each in a directory of its own, kept from an earlier start if it came to its end."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from analysis.figures import BeadHistory, SpaceTime
from analysis.tracking.leading_waves import Waves, leading_waves
from analysis.tracking.peaks import PeakFinder
from lammps_inputs import Problem, Scene, strict_yaml
from lammps_inputs.decks import deck
from workflow.runs.run import run
from workflow.runs.run_directory import RunDirectory

Say = Callable[[str], None]


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
    path = folder / f"{scene.name}-{engine}"
    directory = _finished(path, scene, engine)
    if directory is None:
        say(f"{scene.name}: {engine}")
        directory = run(scene, path, engine=engine, overwrite=True).directory
    problem, record = directory.problem, directory.record
    finder, spacetime, history = PeakFinder(first_only=True), SpaceTime(problem), BeadHistory(problem, (bead,))
    for block in directory.blocks():
        for watcher in (finder, spacetime, history):
            watcher.add(block)
    if engine == "lammps":
        errors = (record["check"]["amplitude"], record["check"]["arrival"])
    else:
        errors = (record["certificate"]["velocity"], record["certificate"]["arrival"])
    return Measured(problem, leading_waves(finder.result()), *errors, spacetime, history)


def _finished(path: Path, scene: Scene, engine: str) -> RunDirectory | None:
    """An earlier run of just this scene that came to its end."""
    if not (path / deck.SCENE).is_file():
        return None
    directory = RunDirectory(path)
    same = (path / deck.SCENE).read_text(encoding="utf-8") == strict_yaml.dump(scene.resolved().plain())
    record = directory.record
    checked = "check" in record or "certificate" in record
    return (
        directory if same and checked and record.get("outcome") == "done" and record.get("engine") == engine else None
    )
