"""Rigid beads: from which collision on a run follows rounding."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

from granchain.parts import Fact, Survey, measurement, quantity
from workflow.plugins.rigid.runs import RigidRecord


@quantity.result
class FirstByRounding:
    """First collision of rigid beads that follows rounding."""

    collision: int | None = quantity.declare(
        "number of the first collision that a change of the gap by 4e-15 of it changes: a displacement by 0.001 of the "
        "gap or the impulse by 0.001 m V; rounding decides it and those after it",
        undefined="none follows rounding",
    )
    row: int | None = quantity.declare("number of the bead that strikes in it", undefined="as ``collision``")
    time: float | None = quantity.declare("its time", "time", "as ``collision``", "t")


@dataclass(frozen=True, repr=False)
class RoundingMeasurement(measurement.Measurement):
    """The first collision that follows rounding."""

    key, kind = "rounding", FirstByRounding

    values: FirstByRounding

    def lines(self) -> Iterator[str]:
        """Which results follow rounding."""
        first = self.values
        if first.collision is not None and first.time is not None:
            time = self.problem.scale.written(first.time, "time", ".5g")
            yield (
                f"warning: from collision {first.collision} on (row {first.row}, t = {time}) the motion follows "
                "rounding, and no result that depends on it is a property of the scene; in waves.csv the "
                "uncertainties of these passages are empty"
            )

    @classmethod
    def of_run(cls, run: measurement.Recorded, survey: Survey, measured: None) -> Self | None:
        """First collision of rigid beads that follows rounding, from the record of the run."""
        del survey, measured
        if run.problem.system.holds(Fact.OVERLAPS):
            return None
        values = FirstByRounding(None, None, None)
        if isinstance(run.job, RigidRecord) and run.job.rounding is not None:
            rounding = run.job.rounding
            values = FirstByRounding(rounding.collision, rounding.row, rounding.time / run.problem.scale.time)
        return cls(run.problem, values)
