"""The largest velocity backwards that any bead has: a quantity of a run."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analysis.quantity import QuantityColumn, declare, result
from analysis.sharing.survey import Survey
from analysis.trajectory import Trajectory
from workflow.measures.base import FrameMeter, Measurement
from workflow.runs.run_directory import RunDirectory


@result
class Backwards:
    """Largest velocity backwards."""

    largest: float = declare(
        "largest velocity of any bead towards lower numbers, at the frames",
        "velocity",
        columns=(QuantityColumn("largest_backwards", "largest velocity backwards"),),
    )


@dataclass(frozen=True, repr=False)
class Rebound(Measurement):
    """Velocity backwards, of every run."""

    key, kind = "rebound", Backwards

    values: Backwards

    def lines(self) -> Iterator[str]:
        """The largest velocity in one line."""
        yield f"largest velocity backwards {self.problem.scale.written(self.values.largest, 'velocity')}"

    @classmethod
    def meter(cls, directory: RunDirectory) -> FrameMeter:
        """The largest over all frames."""
        largest = [0.0]

        def add(block: Trajectory) -> None:
            largest[0] = max(largest[0], float(np.nanmax(-block.velocity)))

        def finish(_: Survey) -> Rebound:
            return cls(directory.problem, Backwards(largest[0]))

        return FrameMeter(finish, add)
