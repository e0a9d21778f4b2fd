"""The leading waves as an MDAnalysis analysis: ``LeadingWaves(universe, problem).run(start, stop, step).results``."""

from typing import Any

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.analysis.results import Results, ResultsGroup

import analysis.mda.formats  # noqa: F401  registers the readers
from analysis.files import recording
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peaks import THRESHOLD, PeakFinder
from analysis.trajectory import Trajectory
from lammps_inputs import Problem

_BLOCK = 64  # frames


class LeadingWaves(AnalysisBase):  # type: ignore[misc]  # MDAnalysis has no types
    """Arrival, peak velocity and local speed of the leading pulse at every recorded bead, dimensionless.

    ``results`` has the columns of `analysis.tracking.leading_waves.Waves`: ``chain``, ``bead``, ``pulse``,
    ``arrival``, ``peak_velocity``, ``speed``. Frames must be evenly spaced. Runs in several processes, too, with at
    most four ``n_parts`` for each of ``n_workers``: with more, MDAnalysis itself mixes up what they return.

    Args:
        universe: made from a run's ``data.chains`` and ``chains.dump.bin``.
        problem: what was run.
        threshold: smallest peak that counts, in units of V.

    Raises:
        ValueError: the universe has other atoms than the problem, or lacks the columns in float64, as one in memory.
    """

    _analysis_algorithm_is_parallelizable = True

    def __init__(self, universe: Any, problem: Problem, threshold: float = THRESHOLD, **kwargs: Any) -> None:
        super().__init__(universe.trajectory, **kwargs)
        self._problem = problem
        self._threshold = threshold
        self._columns = problem.columns
        atoms = len(recording.all_ids(problem))
        if universe.trajectory.n_atoms != atoms:
            raise ValueError(f"{universe}: {problem.name} has {atoms} recorded beads")
        missing = [name for name in self._columns if name not in universe.trajectory.ts.data]
        if missing:
            raise ValueError(
                f"{universe.trajectory}: ts.data has no {missing[0]!r}; waves are found in our dumps as they are read, "
                "not in memory"
            )

    @classmethod
    def get_supported_backends(cls) -> tuple[str, ...]:
        """Backends of MDAnalysis with which the analysis can be run."""
        return ("serial", "multiprocessing")

    def _get_aggregator(self) -> ResultsGroup:
        return ResultsGroup({"_part": ResultsGroup.flatten_sequence})

    def _prepare(self) -> None:
        self.results = Results(_part=[_ContinuedPeaks(self._threshold)])  # without those of an earlier run
        self._pending: list[tuple[float, Any]] = []

    def _single_frame(self) -> None:
        data = self._ts.data
        if data["step"] % self._problem.steps_per_frame:
            raise ValueError(
                f"there is a frame of step {data['step']}, but the problem's are {self._problem.steps_per_frame} steps "
                "apart; give that of the scene.yaml of the run"
            )
        self._pending.append((data["step"] * self._problem.timestep, np.array([data[name] for name in self._columns])))
        if len(self._pending) == _BLOCK or self._frame_index == self.n_frames - 1:
            time, values = (np.array(column) for column in zip(*self._pending, strict=True))
            self.results._part[0].add(list(recording.of_frames(self._problem, time, values)))
            self._pending.clear()

    def _conclude(self) -> None:
        if len(set(np.diff(self.frames).tolist())) > 1 or np.any(np.diff(self.frames) < 1):
            raise ValueError("waves are found in frames that are evenly spaced and ascending")
        finder = PeakFinder(self._threshold)
        for part in self.results.pop("_part"):
            part.follow(finder)
        waves = leading_waves(finder.result(), self._problem)
        for name in ("chain", "bead", "pulse", "arrival", "peak_velocity", "speed"):
            self.results[name] = getattr(waves, name)


class _ContinuedPeaks:
    """Peaks in frames in the midst of a run: found from the second block on, so that they continue any before."""

    def __init__(self, threshold: float) -> None:
        self._head: list[Trajectory] = []
        self._beyond = False
        self._finder = PeakFinder(threshold)

    def add(self, blocks: list[Trajectory]) -> None:
        """Take the next frames."""
        for block in blocks:
            self._finder.add(block)
        if self._head:
            self._beyond = True
        else:
            self._head = blocks
            self._finder.forget()

    def follow(self, finder: PeakFinder) -> None:
        """Continue a finder through these frames, with what was found in them already."""
        for block in self._head:
            finder.add(block)
        if self._beyond:
            finder.take_over(self._finder)
