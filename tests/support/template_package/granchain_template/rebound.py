"""The largest velocity backwards that any bead has: a quantity of a run."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granchain.parts import Meter, Part, measurement, quantity


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
        del run
        return ReboundMeter()


class ReboundMeter(Meter[float, Backwards]):
    """Largest velocity backwards."""

    def of_part(self, part: Part) -> float:
        """The largest in the frames of a part."""
        return float(np.nanmax(-part.frames.velocity))

    def result(self, pieces: list[float]) -> Backwards:
        """The largest in all frames."""
        return Backwards(max(0.0, *pieces))
