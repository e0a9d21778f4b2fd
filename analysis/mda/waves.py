"""The leading waves as an MDAnalysis analysis: ``LeadingWaves(universe, problem).run(start, stop, step).results``."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.analysis.results import Results, ResultsGroup

import analysis.mda.formats  # noqa: F401  registers the readers
from analysis.files import recording
from analysis.meters import AFTER, BEFORE, parts_of
from analysis.tracking.leading_waves import leading_waves
from analysis.tracking.peak_bounds import Brackets
from analysis.tracking.peaks import THRESHOLD, PeakMeter
from analysis.trajectory import Floats
from lammps_inputs import Problem

Frame = tuple[float, Floats]
"""Time in units of T, and values [column, atom] (`analysis.files.recording.of_frames`)."""

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
        self._meter = PeakMeter(threshold)
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
        self.results = Results(_part=[_Stretch()])  # without those of an earlier run
        self._pending: list[Frame] = []

    def _single_frame(self) -> None:
        data = self._ts.data
        if data["step"] % self._problem.steps_per_frame:
            raise ValueError(
                f"there is a frame of step {data['step']}, but the problem's are {self._problem.steps_per_frame} steps "
                "apart; give that of the scene.yaml of the run"
            )
        values = np.array([data[name] for name in self._columns])
        self._pending.append((data["step"] * self._problem.timestep, values))
        stretch = self.results._part[0]
        if len(self._pending) == BEFORE + _BLOCK + AFTER:
            stretch.head = stretch.head or self._pending[: BEFORE + AFTER]
            stretch.pieces += self._pieces(self._pending, BEFORE, BEFORE + _BLOCK)
            del self._pending[:_BLOCK]
        stretch.tail = self._pending

    def _pieces(self, frames: list[Frame], first: int, end: int) -> list[Brackets]:
        """Brackets of the maxima in some of consecutive frames, from a position on and to another one."""
        if not frames:
            return []
        time, values = (np.array(column) for column in zip(*frames, strict=True))
        pieces = []
        for part in parts_of(recording.of_frames(self._problem, time, values)):
            low, high = max(first, part.start), min(end, part.start + part.count)
            if low < high:
                before = part.before + low - part.start
                pieces.append(self._meter.of_part(replace(part, before=before, count=high - low, start=low)))
        return pieces

    def _conclude(self) -> None:
        if len(set(np.diff(self.frames).tolist())) > 1 or np.any(np.diff(self.frames) < 1):
            raise ValueError("waves are found in frames that are evenly spaced and ascending")
        pieces: list[Brackets] = []
        border: list[Frame] = []  # frames around the end of a stretch
        first = 0
        for stretch in self.results.pop("_part"):
            border = border + stretch.head
            if stretch.pieces:
                pieces += self._pieces(border, first, len(border) - AFTER) + stretch.pieces
                border, first = [], BEFORE
            border = border + stretch.tail
        pieces += self._pieces(border, first, len(border))
        if not pieces:
            raise ValueError("no frames to analyse")
        waves = leading_waves(self._meter.result(pieces), self._problem)
        for name in ("chain", "bead", "pulse", "arrival", "peak_velocity", "speed"):
            self.results[name] = getattr(waves, name)


@dataclass
class _Stretch:
    """Consecutive frames that one process reads.

    Attributes:
        head: the first frames, some of which are not searched yet; none where all are in the tail.
        pieces: brackets of maxima in the frames in the middle.
        tail: the last frames, some of which are not searched yet, and `BEFORE` others before these.
    """

    head: list[Frame] = field(default_factory=list)
    pieces: list[Brackets] = field(default_factory=list)
    tail: list[Frame] = field(default_factory=list)
