"""Uncertainty of the reference: the same problem at half the number of steps."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from analysis.compare.common_times import on_common_rows, paired_parts, velocity_error
from analysis.compare.difference import Uncertainty, matched
from analysis.conservation import ConservationMeter
from analysis.meters import Part
from analysis.tracking.leading_passages import leading_meter, leading_passages
from analysis.tracking.peaks import sharp
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from lammps_inputs.limits import rates
from workflow.engines.reference import engine
from workflow.errors import RunError

MOST_HALVINGS = 12

SAFETY = 3.0
"""Uncertainty over the difference of the two runs. The difference alone would do if errors fell evenly, as the step
to the power 2.5 or faster; but the contacts' singularities fall on other parts of a step in each run. Measured: in one
of a hundred random scenes the error of the finer run exceeded the difference, mostly less than 2.4 times; in 3246
others the uncertainty was exceeded once by a velocity, by a quarter, and in 14 by an arrival, at most 5 times.
"""


class StepHalving:
    """Runs a problem at two steps side by side; its `blocks` are the finer run's, its `uncertainty` bounds their error.

    Args:
        problem: what to integrate.
        steps_per_frame: steps of the finer run from frame to frame, rounded up to an even number; by default
            `engine.default_steps_per_frame`.
        velocity_only: whether to leave the bounds on arrivals, energy and momentum NaN, which take most of the time.

    Examples:
        >>> problem = granchain.load("one-chain", {"beads": 20, "duration": 5.0}).problem()
        >>> halving = StepHalving(problem)
        >>> sum(block.frames for block in halving.blocks()), halving.uncertainty.velocity < 1e-5
        (51, True)
    """

    def __init__(self, problem: Problem, *, steps_per_frame: int | None = None, velocity_only: bool = False) -> None:
        steps = steps_per_frame or engine.default_steps_per_frame(problem)
        self.problem = problem
        self.steps_per_frame = steps + steps % 2
        self._velocity_only = velocity_only
        self._leading, self._conserved = leading_meter(problem), ConservationMeter(problem)
        self._pieces: list[tuple[Any, ...]] = []

    def blocks(self) -> Iterator[Trajectory]:
        """The finer run's frames from the start; the uncertainty is about those that were taken.

        Raises:
            RunError: velocities of one of the runs are not finite.
        """
        self._pieces = []
        rows = compared_rows(self.problem)
        runs = (
            engine.blocks(self.problem, steps_per_frame=steps, rows=rows)
            for steps in (self.steps_per_frame, self.steps_per_frame // 2)
        )
        pairs = itertools.starmap(on_common_rows, zip(*runs, strict=True))
        for fine, coarse in paired_parts(pairs):
            self._pieces.append(self._of_parts(fine, coarse))
            yield fine.frames

    def _of_parts(self, fine: Part, coarse: Part) -> tuple[Any, ...]:
        """Largest difference of the velocities in parts of both runs, and what the other bounds follow from.

        Raises:
            RunError: velocities of one of the runs are not finite.
        """
        with np.errstate(invalid="ignore"):
            difference = velocity_error(fine.frames, coarse.frames)
        if not math.isfinite(difference):
            raise RunError(_not_finite(fine.frames, coarse.frames))
        if self._velocity_only:
            return (difference,)
        peaks = (self._leading.of_part(part) for part in (fine, coarse))
        return difference, self._conserved.of_part(fine), *peaks

    def run(self) -> Uncertainty:
        """Take all blocks; bounds on their errors."""
        for _ in self.blocks():
            pass
        return self.uncertainty

    @property
    def uncertainty(self) -> Uncertainty:
        """Bounds on the errors of the blocks that were taken."""
        differences, *others = (list(of_parts) for of_parts in zip(*self._pieces, strict=True))
        velocity = SAFETY * max(differences)
        if self._velocity_only:
            unknown = dict.fromkeys(("arrival", "energy", "momentum"), math.nan)
            return Uncertainty(self.steps_per_frame, velocity, **unknown)
        drifts, *brackets = others
        conservation = self._conserved.result(drifts)
        fine, coarse = (leading_passages(self._leading.result(of_run), self.problem).first() for of_run in brackets)
        fine, coarse = matched(fine, coarse, self.problem.beads)
        arrival = float(np.max(np.abs(fine.time - coarse.time)[sharp(fine)], initial=0.0))
        return Uncertainty(
            steps_per_frame=self.steps_per_frame,
            velocity=velocity,
            arrival=SAFETY * arrival,
            energy=conservation.energy_drift,
            momentum=conservation.momentum_drift,
        )


def _not_finite(*runs: Trajectory) -> str:
    bad = ~np.all([np.isfinite(run.atoms[1]) for run in runs], axis=(0, 2, 3))
    until = runs[0].problem.scale.written(runs[0].time[int(np.argmax(bad))], "time")
    return (
        f"by t = {until} velocities of the reference are no longer finite numbers: oscillations grow, or a force does "
        "that the beads reach; take a shorter duration, or see to the law of that force"
    )


def compared_rows(problem: Problem) -> int | None:
    """Rows that the reference of a windowed run integrates; None for the engine's own choice.

    The engine's choice suits a window that moves. One that has stood at the end of the chains for long may lack the
    slower pulses behind it, which only the complete chains show.
    """
    if not problem.rows.follow:
        return None
    before_last = problem.beads - 1
    leading = engine.passages(
        replace(problem, rows=problem.rows.near_front(None)),
        rows=engine.WIDER * problem.rows.existing,
        until_bead=before_last,
    )
    arrival = float(np.min(leading.arrival[leading.bead == before_last], initial=problem.duration))
    # the pulses that the window lacks would have to come from behind its tail
    return (
        problem.beads
        if rates.front_speed(problem.system) * (problem.duration - arrival) > problem.rows.existing / 2.0
        else None
    )


def accurate_reference(problem: Problem, tolerance: float) -> StepHalving:
    """A halving whose run is within a tolerance in every velocity: steps are halved until the uncertainty says so.

    The returned halving has run once; its `blocks` run again.

    Args:
        problem: what to integrate.
        tolerance: in units of V; about 1e-11 is the least that rounding allows.

    Raises:
        RunError: not reached before steps are 4096 times shorter than the default.
    """
    steps = engine.default_steps_per_frame(problem)
    for _ in range(MOST_HALVINGS):
        halving = StepHalving(problem, steps_per_frame=steps)
        if halving.run().velocity <= tolerance:
            return halving
        steps *= 2
    raise RunError(f"the reference does not reach an error of {tolerance:.1e}; rounding is in the way")
