"""What a window leaves behind: the residual motion of beads, and whether it could catch up with a leading wave.

The higher a pulse, the faster it runs; so nothing that a window has left reaches the leading waves as long as the beads
in it move more slowly than any of these waves is high.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Self

from analysis.meters import Meter, Part
from analysis.quantity import declare, derived, result
from analysis.sharing.survey import Survey
from analysis.trajectory import Floats
from workflow.measures.measurement import Measurement, Recorded


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


class LeftBehind(NamedTuple):
    """Largest velocity of a bead when a window left it, in units of V, and the number of the bead; 0 without any."""

    velocity: float = 0.0
    bead: int = 0


class WindowMeter(Meter[tuple[int, Floats], LeftBehind]):
    """Largest velocity that a window leaves behind."""

    def of_part(self, part: Part) -> tuple[int, Floats]:
        """First bead of the window, and the largest velocity of each bead in the last frame of the part, [bead]."""
        return part.frames.first, part.frames.velocity[-1].max(axis=0)

    def result(self, pieces: list[tuple[int, Floats]]) -> LeftBehind:
        """The largest of the velocities, [bead], of beads that parts have left."""
        left = LeftBehind()
        for (first, velocity), (following, _) in itertools.pairwise(pieces):
            behind = velocity[: following - first]
            if len(behind) and behind.max() > left.velocity:
                left = LeftBehind(float(behind.max()), first + int(behind.argmax()))
        return left


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
        return WindowMeter() if run.problem.rows.follow else None

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: LeftBehind | None) -> Self | None:
        """Residual motion, with the amplitude of the lowest leading wave from the middle of the first window on."""
        rows, waves = run.problem.rows.width, survey.waves
        if measured is None or rows is None:
            return None
        amplitude = waves.peak_velocity[waves.bead > rows // 2]
        slowest = float(amplitude.min()) if len(amplitude) else math.nan
        return cls(run.problem, Residual(rows, measured.velocity, measured.bead, slowest))
