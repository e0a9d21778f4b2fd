"""How sure the reference is of itself: the same problem at half the number of steps, and a third time for the order."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analysis.conservation import Conservation
from analysis.peaks import PeakFinder
from analysis.trajectory import Trajectory
from analysis.waves import leading_waves
from lammps_inputs import Problem
from workflow.engines.reference import engine
from workflow.engines.reference.blanes_moan import BLANES_MOAN
from workflow.engines.reference.scheme import Scheme
from workflow.errors import RunError

MOST_HALVINGS = 12


@dataclass(frozen=True)
class Certificate:
    """What is known of a reference run, dimensionless.

    Attributes:
        steps_per_frame: of the run that it certifies.
        velocity, arrival: bounds on its errors: its largest differences from the run with half as many steps, whose
            own error is at least 2**2.5 - 1 = 4.7 times as large (the order never falls below 2.5).
        energy, momentum: largest deviations from the kicks'.
        order: measured from a third run with a quarter of the steps; None where it was not asked for.
    """

    steps_per_frame: int
    velocity: float
    arrival: float
    energy: float
    momentum: float
    order: float | None


class Certifier:
    """Runs a problem at two steps side by side; its `blocks` are the finer run's, its `certificate` bounds their error.

    Args:
        problem: what to integrate.
        steps_per_frame: of the finer run, even; by default `engine.default_steps_per_frame`.
        with_order: whether to run a third time, with a quarter of the steps (a multiple of 4 is then needed).
        scheme: how to integrate.
    """

    def __init__(
        self,
        problem: Problem,
        *,
        steps_per_frame: int | None = None,
        with_order: bool = False,
        scheme: Scheme = BLANES_MOAN,
    ) -> None:
        steps = steps_per_frame or engine.default_steps_per_frame(problem)
        self.problem = problem
        self.steps_per_frame = steps + steps % (4 if with_order else 2)
        self._divisors = (1, 2, 4) if with_order else (1, 2)
        self._scheme = scheme
        self._velocity = np.zeros(len(self._divisors) - 1)
        self._finders = (PeakFinder(first_only=True), PeakFinder(first_only=True))
        self._conservation = Conservation()

    def blocks(self) -> Iterator[Trajectory]:
        """The finer run's frames; the certificate is ready when they are used up."""
        runs = [
            engine.blocks(self.problem, scheme=self._scheme, steps_per_frame=self.steps_per_frame // divisor)
            for divisor in self._divisors
        ]
        for fine, *coarser in zip(*runs, strict=True):
            before = fine
            for k, coarse in enumerate(coarser):
                self._velocity[k] = max(self._velocity[k], float(np.max(np.abs(before.velocity - coarse.velocity))))
                before = coarse
            for finder, block in zip(self._finders, (fine, coarser[0]), strict=True):
                finder.add(block)
            self._conservation.add(fine)
            yield fine

    @property
    def certificate(self) -> Certificate:
        """Bounds on the errors of the blocks that were yielded."""
        fine, coarse = (leading_waves(finder.result()) for finder in self._finders)
        same = len(fine) == len(coarse) and bool(np.all(fine.bead == coarse.bead))
        inner = fine.bead < fine.bead.max(initial=0)
        arrival = float(np.max(np.abs(fine.arrival - coarse.arrival)[inner], initial=0.0)) if same else math.inf
        order = None
        if len(self._velocity) > 1:
            order = float(np.log2(self._velocity[1] / self._velocity[0])) if self._velocity[0] > 0.0 else math.inf
        return Certificate(
            steps_per_frame=self.steps_per_frame,
            velocity=float(self._velocity[0]),
            arrival=arrival,
            energy=self._conservation.energy_drift,
            momentum=self._conservation.momentum_drift,
            order=order,
        )


def certified(problem: Problem, tolerance: float) -> Certifier:
    """A certifier whose run is within a tolerance in every velocity: steps are halved until the certificate says so.

    The returned certifier has run once; its `blocks` run again.

    Args:
        problem: what to integrate.
        tolerance: in units of V; about 1e-11 is the least that rounding allows.

    Raises:
        RunError: not reached before steps are 4096 times shorter than the default.
    """
    steps = engine.default_steps_per_frame(problem)
    for _ in range(MOST_HALVINGS):
        certifier = Certifier(problem, steps_per_frame=steps)
        for _ in certifier.blocks():
            pass
        if certifier.certificate.velocity <= tolerance:
            return certifier
        steps *= 2
    raise RunError(f"the reference does not reach an error of {tolerance:.1e}; rounding is in the way")
