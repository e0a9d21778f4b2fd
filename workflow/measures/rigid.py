"""Rigid beads: from which collision on a run follows rounding."""

from collections.abc import Iterator
from dataclasses import dataclass

from analysis.quantity import declare, result
from workflow.measures.base import FrameMeter, Measurement, Recorded


@result
class FirstByRounding:
    """First collision of rigid beads that follows rounding."""

    collision: int | None = declare(
        "number of the first collision that a change of the gap by 4e-15 of it changes: a displacement by 0.001 of the "
        "gap or the impulse by 0.001 m V; rounding decides it and those after it",
        undefined="none follows rounding",
    )
    row: int | None = declare("number of the bead that strikes in it", undefined="as ``collision``")
    time: float | None = declare("its time", "time", "as ``collision``", "t")


@dataclass(frozen=True, repr=False)
class RoundingMeasurement(Measurement):
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
    def meter(cls, run: Recorded) -> FrameMeter | None:
        """Rigid beads."""
        if run.deforms:
            return None
        values = FirstByRounding(None, None, None)
        if run.rounding is not None:
            time = run.rounding.time / run.problem.scale.time
            values = FirstByRounding(run.rounding.collision, run.rounding.row, time)
        return FrameMeter(lambda _: cls(run.problem, values))
