"""The largest velocity backwards that any bead has: a quantity of a run."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granchain.parts import Problem, Survey, Trajectory, measurement, quantity


@quantity.result
class Backwards:
    """Largest velocity backwards."""

    largest: float = quantity.declare(
        "largest velocity of any bead towards lower numbers, at the frames",
        "velocity",
        columns=(quantity.QuantityColumn("largest_backwards", "largest velocity backwards"),),
    )


@dataclass(frozen=True, repr=False)
class Rebound(measurement.Measurement):
    """Velocity backwards, of every run."""

    key, kind = "rebound", Backwards

    values: Backwards

    def lines(self) -> Iterator[str]:
        """The largest velocity in one line."""
        yield f"largest velocity backwards {self.problem.scale.written(self.values.largest, 'velocity')}"

    @classmethod
    def meter(cls, run: measurement.Recorded) -> "ReboundMeter":
        """The largest over all frames."""
        return ReboundMeter(run.problem)


class ReboundMeter(measurement.Meter):
    """Largest velocity backwards so far."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._largest = 0.0

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        self._largest = max(self._largest, float(np.nanmax(-block.velocity)))

    def finish(self, survey: Survey) -> Rebound:
        """The largest in all frames."""
        del survey
        return Rebound(self.problem, Backwards(self._largest))
