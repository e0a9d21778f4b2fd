"""Units of the numbers on a page: with the prefixes of the run's figures, so that axes need no powers of ten."""

from dataclasses import dataclass

from granchain.parts import Problem, units


@dataclass(frozen=True)
class PageUnit:
    """Unit of numbers on a page.

    Attributes:
        worth: of one dimensionless unit, in it.
        symbol: such as ``ms``; empty for reduced units.
    """

    worth: float
    symbol: str

    @property
    def behind(self) -> str:
        """What stands behind a number: ``" ms"``, or nothing."""
        return f" {self.symbol}" if self.symbol else ""

    def label(self, words: str, symbol: str) -> str:
        """Text of an axis, such as ``time t (ms)``, from words and a symbol in TeX."""
        return units.Label(words, symbol, self.symbol or "reduced").plain


Units = dict[str, PageUnit]


def page_unit(problem: Problem, kind: str, largest: float) -> PageUnit:
    """Unit of a quantity; reduced units as they are.

    Args:
        problem: what was run.
        kind: of the quantity, such as ``time`` (a key of `lammps_inputs.units.SI`).
        largest: size of the largest number, dimensionless.
    """
    scale = problem.scale
    worth = float(scale.measured(1.0, kind))
    if not scale.si:
        return PageUnit(worth, "")
    prefixed, factor = units.Label("", unit=scale.symbol(kind)).prefixed(largest * worth)
    return PageUnit(worth * factor, prefixed.unit)


SYMBOLS = {"time": "t", "velocity": "v", "force": "F", "energy": "U"}
"""Quantity of an axis -> its symbol."""


def axis_label(name: str, unit: PageUnit) -> str:
    """Text of an axis of one of `SYMBOLS`, such as ``time t (ms)``."""
    return unit.label(name, SYMBOLS[name])
