"""The leading waves as an MDAnalysis analysis: ``LeadingWaves(universe, problem).run(start, stop, step).results``."""

from typing import Any

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase

import analysis.mda.formats  # noqa: F401  registers the readers
from analysis.tracking.leading_waves import leading_waves, usual_arrival
from analysis.tracking.peaks import THRESHOLD, PeakFinder
from analysis.tracking.which_leads import beyond_kicks
from analysis.trajectory import Trajectory
from lammps_inputs import Problem


class LeadingWaves(AnalysisBase):  # type: ignore[misc]  # MDAnalysis has no types
    """Arrival, peak velocity and local speed of the leading pulse at every recorded bead, dimensionless.

    ``results`` has the columns of `analysis.tracking.leading_waves.Waves`: ``chain``, ``bead``, ``arrival``,
    ``peak_velocity``, ``speed``.

    Args:
        universe: made from a run's ``data.chains`` and ``chains.dump.bin``.
        problem: what was run.
        threshold: smallest peak that counts, in units of V.
    """

    def __init__(self, universe: Any, problem: Problem, threshold: float = THRESHOLD, **kwargs: Any) -> None:
        super().__init__(universe.trajectory, **kwargs)
        self._problem = problem
        self._threshold = threshold

    def _prepare(self) -> None:
        self._finder = PeakFinder(self._threshold)
        self._pending: list[tuple[float, Any, Any]] = []

    def _single_frame(self) -> None:
        data, problem = self._ts.data, self._problem
        time = data["step"] * problem.timestep
        shape = (problem.chains, len(problem.recorded_beads))
        self._pending.append((time, data["displacement"].reshape(shape).copy(), data["velocity"].reshape(shape).copy()))
        if len(self._pending) == 64:
            self._pass_on()

    def _pass_on(self) -> None:
        if self._pending:
            time, displacement, velocity = (np.array(column) for column in zip(*self._pending, strict=True))
            self._finder.add(Trajectory(self._problem, time, displacement, velocity))
            self._pending.clear()

    def _conclude(self) -> None:
        self._pass_on()
        passages = beyond_kicks(self._finder.result(), self._problem)
        waves = leading_waves(passages, usual_arrival(self._problem))
        for name in ("chain", "bead", "arrival", "peak_velocity", "speed"):
            self.results[name] = getattr(waves, name)
