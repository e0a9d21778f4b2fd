"""Analyse a run directory: ``waves.csv``, ``analysis.json`` and the figures beside the frames, which are read twice."""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.binary_dump import CutDumpWarning
from analysis.conservation import Conservation
from analysis.left_behind import LeftBehind
from analysis.recording import FARTHEST
from analysis.solitary import Tolerances
from analysis.survey import Survey, survey
from analysis.trajectory import Trajectory
from analysis.waves import Waves
from lammps_inputs import InputError, Problem
from workflow.analysis_report import last_clear_bead, report, waves_csv
from workflow.own_files import claim
from workflow.run_directory import REPORT, RunDirectory, figure_files, write_figure, write_json, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Analysis", "analyse", "default_beads", "last_clear_bead"]

WAVES = "waves.csv"


@dataclass(frozen=True)
class Analysis:
    """What was found in a run.

    Attributes:
        survey: the waves, pulses, energies and the verdict, dimensionless.
        conservation: energy, momentum, frames seen.
        complete: whether the dump holds every frame that the scene asks for.
        figures: files drawn.
        left: what a window has left behind; None without a window.
        failure: why the run failed; empty where it did not.
    """

    problem: Problem
    survey: Survey
    conservation: Conservation
    complete: bool
    figures: tuple[Path, ...]
    left: LeftBehind | None
    failure: str

    @property
    def waves(self) -> Waves:
        """The leading pulse at every bead, dimensionless."""
        return self.survey.waves


def analyse(
    directory: RunDirectory,
    *,
    beads: tuple[int, ...] | None = None,
    figures: bool = True,
    tolerances: Tolerances | None = None,
) -> Analysis:
    """Analyse what a directory holds, also of a run that was cut short.

    Args:
        directory: a run directory.
        beads: whose velocity over time is drawn; by default three beads along the way of the pulse.
        figures: whether to draw.
        tolerances: within which a pulse is called solitary; by default 1% each.

    Raises:
        InputError: no frames, or a bead that was not recorded.
    """
    problem, allowed = directory.problem, tolerances or Tolerances()
    shown = default_beads(problem) if beads is None else beads
    for bead in shown:
        if bead not in problem.recorded_beads:
            raise InputError(f"--beads: bead {bead} is not among the recorded ones")
    if problem.every > FARTHEST * (1.0 + 1e-9):
        limit = FARTHEST * problem.scale.time
        raise InputError(
            f"{directory.path}: its frames are {problem.every * problem.scale.time:.4g} apart, too far to find waves "
            f"between them; run it with output.every at most {limit:.4g}"
        )
    conservation = Conservation()
    left = LeftBehind() if problem.window is not None else None
    watchers: list[Any] = [conservation]
    if left is not None:
        watchers.append(left)
    spacetime = history = None
    if figures:
        from analysis.figures import BeadHistory, SpaceTime  # matplotlib takes half a second to import

        history = BeadHistory(problem, shown)
        spacetime = SpaceTime(problem if problem.frames_per_snapshot is None else problem.snapshots())
        watchers += [history] if problem.frames_per_snapshot is not None else [history, spacetime]

    found = survey(lambda: _quietly(directory.blocks()), problem, watchers=watchers, tolerances=allowed)
    if problem.frames_per_snapshot is not None:
        whole = Conservation()
        for block in _quietly(directory.snapshots()):
            whole.add(block)
            if spacetime is not None:
                spacetime.add(block)
        spacetime = spacetime if whole.frames > 1 else None
        conservation.energy_drift, conservation.momentum_drift = whole.energy_drift, whole.momentum_drift
    figures_of = _makers(found, spacetime, history) if figures else {}
    claim(directory.path, (WAVES, REPORT, *figure_files(*figures_of)))
    drawn = tuple(path for name, make in figures_of.items() for path in write_figure(directory.path, name, make()))
    write_text(directory.path / WAVES, waves_csv(found))
    write_json(directory.path / REPORT, report(found, conservation, allowed, left))
    complete = conservation.frames == problem.frames + 1
    return Analysis(problem, found, conservation, complete, drawn, left, directory.failure)


def _quietly(blocks: Iterator[Trajectory]) -> Iterator[Trajectory]:
    """Blocks without a warning of a cut frame at their end: that the run is incomplete is said in words."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CutDumpWarning)
        yield from blocks


def default_beads(problem: Problem) -> tuple[int, ...]:
    """Three recorded beads, near a sixth, a half and nine tenths of the way."""
    recorded = problem.recorded_beads
    places = np.unique(np.round(np.array([0.17, 0.5, 0.9]) * (len(recorded) - 1)).astype(int))
    return tuple(int(recorded[place]) for place in places)


def _makers(found: Survey, spacetime: Any, history: Any) -> "dict[str, Callable[[], Figure]]":
    """Name -> what draws the figure; those that there is something to show in."""
    from analysis.figures import distance_figure, response_figure, shape_figure, spacetime_figure

    problem = found.problem
    makers: dict[str, Callable[[], Figure]] = {"response": lambda: response_figure(history)}
    if spacetime is not None and len(spacetime.beads) > 1:
        makers["spacetime"] = lambda: spacetime_figure(spacetime)
    if len(found.shared) > 1:
        makers["distance"] = lambda: distance_figure(problem, found.shared, found.energies, found.direction)
    whole = np.unique(found.waves.bead[np.isfinite(found.shape.residual)])
    whole = whole[whole <= problem.beads - 5]
    if len(whole):
        early, late = whole[min(len(whole) - 1, int(np.searchsorted(whole, 10)))], whole[-1]
        makers["shape"] = lambda: shape_figure(problem, found.waveforms, sorted({int(early), int(late)}))
    return makers
