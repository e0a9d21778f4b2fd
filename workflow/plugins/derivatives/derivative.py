"""Derivative of a quantity of a scene by one of its fields, and its line in a printed table."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Derivative:
    """Derivative of a quantity of a scene by one of its fields.

    Attributes:
        quantity: name of the quantity.
        field: dotted path of the field.
        value: the quantity, in the scene's unit; None where it is undefined.
        derivative: change of the quantity over that of the field, in their units; None where the quantity is undefined,
            jumps or bends.
        uncertainty: bound on the error of the derivative by time steps and measurement; None without a derivative.
        unit: unit of the derivative; empty of a number.
        relative: relative change of the quantity over that of the field; None where either is 0 or undefined.
    """

    quantity: str
    field: str
    value: float | None
    derivative: float | None
    uncertainty: float | None
    unit: str
    relative: float | None

    def cells(self) -> list[str]:
        """Cells of a line of the printed table under `HEAD`."""
        names = [self.quantity, self.field]
        if self.derivative is None or self.uncertainty is None:
            return [*names, "-", "undefined" if self.value is None else "jumps", self.unit, "-"]
        digits = _digits(self.derivative, self.uncertainty)
        return [
            *names,
            f"{self.derivative:+.{digits}g}",
            f"{self.uncertainty:.0e}",
            self.unit,
            "-" if self.relative is None else f"{self.relative:+.4f}",
        ]


HEAD = ["quantity", "field", "derivative", "+-", "unit", "relative"]
"""Heading of `Derivative.cells`."""


def _digits(value: float, uncertainty: float) -> int:
    """Significant digits that an uncertainty leaves, 2 to 8."""
    if value == 0.0 or uncertainty == 0.0:
        return 8
    return min(8, max(2, 1 + math.floor(math.log10(abs(value) / uncertainty))))
