"""What a window leaves behind: the residual motion of beads, and whether it could catch up with a leading wave.

The higher a pulse, the faster it runs; so nothing that a window has left reaches the leading waves as long as the beads
in it move more slowly than any of these waves is high.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from analysis.quantity import declare, derived, result
from analysis.sharing.survey import Survey
from analysis.tracking.leading_waves import Waves
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from workflow.measures.measurement import Measurement, Meter, Recorded


@result
class Residual:
    """Residual motion of the beads that the window has left."""

    rows: int | None = declare("rows of the window", "rows")
    residual_velocity: float = declare(
        "largest velocity along the chain of a bead when the window left it; 0 if it left none", "V"
    )
    bead: int = declare("number of that bead; 0 if the window left none")
    slowest_wave: float = declare(
        "amplitude of the lowest leading wave, which ``residual_velocity`` must not exceed",
        "V",
        "the window has not moved",
    )

    @property
    @derived()
    def sentence(self) -> str:
        """Whether residual motion could have caught up with a leading wave, in words."""
        if self.bead == 0:
            return "no motion is left behind the window"
        residual = f"beads behind the window have residual velocities up to {self.residual_velocity:.2g} V"
        if self.residual_velocity < self.slowest_wave:
            return f"{residual}, less than every leading wave ({self.slowest_wave:.2g} V or more): nothing catches up"
        return (
            f"{residual}, a leading wave only {self.slowest_wave:.2g} V: residual motion might catch up; take a wider "
            "window"
        )


class WindowMeter(Meter):
    """Collects what leaves the window of a run that is given block by block."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._velocity = 0.0
        self._bead = 0
        self._before: Trajectory | None = None

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        before = self._before
        if before is not None and block.first > before.first:
            last = before.velocity[-1, :, : block.first - before.first].max(axis=0)
            if last.max() > self._velocity:
                self._velocity, self._bead = float(last.max()), int(before.beads[int(last.argmax())])
        self._before = block

    def result(self, waves: Waves) -> Residual:
        """Residual motion in the frames so far, with the amplitude of the lowest leading wave."""
        rows = self._before.problem.rows.width if self._before is not None else None
        amplitude = waves.peak_velocity[waves.bead > rows // 2] if rows is not None else waves.peak_velocity[:0]
        return Residual(rows, self._velocity, self._bead, float(amplitude.min()) if len(amplitude) else math.nan)

    def finish(self, survey: Survey) -> "WindowMeasurement":
        """Residual motion in all frames."""
        return WindowMeasurement(self.problem, self.result(survey.waves))


@dataclass(frozen=True, repr=False)
class WindowMeasurement(Measurement):
    """Whether it could catch up."""

    key, kind = "window", Residual

    values: Residual

    def lines(self) -> Iterator[str]:
        """The sentence."""
        yield self.values.sentence

    @classmethod
    def meter(cls, run: Recorded) -> WindowMeter | None:
        """Where there is a window."""
        return WindowMeter(run.problem) if run.problem.rows.follow else None
