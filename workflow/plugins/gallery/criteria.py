"""The rule by which a statement of the gallery holds, holds with a correction, or does not hold."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from workflow.plugins.gallery.statements import CORRECTED, FAILS, HOLDS, Statement

RULE = (
    "Rule of the verdicts. Each statement is reduced to quantities, which are measured in the runs of every engine, "
    "and to the range in which each quantity is required to lie. The statement holds if every quantity of every "
    "engine lies in its range; it holds with a correction, which the last column states, if all of them lie in "
    "their wider ranges, given in parentheses; otherwise it does not hold. An undefined quantity lies in no range. "
    "“Published” holds claims and numbers of the cited source only; “derived here” holds what this program computes "
    "beforehand, also from published formulas, and “found” what is measured in the runs. The range about a "
    "published number is half a unit of its last digit unless another one is given."
)

NAMES = {"lammps": "LAMMPS", "reference": "reference"}

Value = TypeVar("Value")


@dataclass(frozen=True)
class RequiredRange:
    """Range in which a quantity must lie, and the wider range in which its statement holds with a correction."""

    lowest: float
    highest: float
    wide_lowest: float
    wide_highest: float

    def verdict(self, value: float) -> str:
        """Verdict on one number; NaN is in no range."""
        if self.lowest <= value <= self.highest:
            return HOLDS
        return CORRECTED if self.wide_lowest <= value <= self.wide_highest else FAILS

    def text(self, unit: str) -> str:
        """Text of the range with a unit, such as ``0.682 ± 0.0005 V (± 0.001 V)``."""
        required, wide = (
            _interval(self.lowest, self.highest, unit),
            _interval(self.wide_lowest, self.wide_highest, unit),
        )
        return required if wide == required else f"{required} ({wide[wide.find('±') :] if '±' in wide else wide})"


def _interval(lowest: float, highest: float, unit: str) -> str:
    if math.isinf(lowest):
        return "any value" if math.isinf(highest) else f"≤ {highest:g}{unit}"
    if math.isinf(highest):
        return f"≥ {lowest:g}{unit}"
    value = 0.5 * (lowest + highest)
    return f"{value:g} ± {highest - value:.2g}{unit}" if highest > lowest else f"{value:g}{unit}"


def near(value: float, within: float, wider: float = 0.0) -> RequiredRange:
    """Range within a distance of a value, and with a correction within a wider one."""
    wider = max(within, wider)
    return RequiredRange(value - within, value + within, value - wider, value + wider)


def at_most(bound: float, wider: float | None = None) -> RequiredRange:
    """Range up to a bound, and with a correction up to a wider one."""
    return RequiredRange(-math.inf, bound, -math.inf, bound if wider is None else wider)


def at_least(bound: float, wider: float | None = None) -> RequiredRange:
    """Range from a bound on, and with a correction from a wider one on."""
    return RequiredRange(bound, math.inf, bound if wider is None else wider, math.inf)


@dataclass(frozen=True)
class MeasuredQuantity:
    """A quantity and the range that it is required to lie in.

    Attributes:
        name: name of the quantity.
        values: value by engine.
        required: the range.
        form: digits after the point (followed by ``e``: in exponential notation) and unit, such as ``3 beads``.
    """

    name: str
    values: Mapping[str, float]
    required: RequiredRange
    form: str = "5"

    @property
    def _unit(self) -> str:
        return " " * (" " in self.form) + self.form.partition(" ")[2]

    @property
    def best(self) -> float:
        """Value by the reference, or the first one where the reference did not run."""
        return self.values.get("reference", next(iter(self.values.values())))

    def text(self, value: float) -> str:
        """A value with its unit."""
        digits = self.form.partition(" ")[0]
        return f"{value:.{digits}}{self._unit}" if digits.endswith("e") else f"{value:.{digits}f}{self._unit}"

    def line(self) -> str:
        """Values, difference of the engines, required range, and deviation from its middle, in one line."""
        sentence = f"{self.name}: " + ", ".join(
            f"{NAMES[engine]} {self.text(value)}" if engine in NAMES else f"{engine}: {self.text(value)}"
            for engine, value in self.values.items()
        )
        if set(self.values) == set(NAMES):
            sentence += f" (they differ by {max(self.values.values()) - min(self.values.values()):.0e})"
        sentence += f"; required: {self.required.text(self._unit)}"
        value = 0.5 * (self.required.lowest + self.required.highest)
        if not math.isfinite(value) or self.required.lowest == self.required.highest or not value:
            return sentence
        return f"{sentence}; deviation {self.best - value:+.1e}{self._unit} ({self.best / value - 1.0:+.2%})"

    def verdict(self) -> str:
        """Verdict on the engine with the worst value."""
        return _worst([self.required.verdict(value) for value in self.values.values()])


def by_engine(values: Mapping[str, Value], text: Callable[[Value], str], before: str = "") -> list[str]:
    """Lines with the value of each engine."""
    return [f"{before}{NAMES[engine]}: {text(value)}" for engine, value in values.items()]


def state(
    *measured: MeasuredQuantity,
    published: str = "",
    source: str = "",
    derived: str = "",
    correction: str = "",
    also: Sequence[str] = (),
) -> Statement:
    """A statement with the verdict that follows from the rule.

    Args:
        measured: quantities to which it is reduced.
        published: the claim of the source.
        source: key of the bibliography, and the place in it: ``rosas2007, abstract``.
        derived: consequence of the claim, or of theory, before anything is run.
        correction: corrected claim where the published one does not hold; by default the first value out of its range.
        also: further lines of measured values.
    """
    holds = _worst([quantity.verdict() for quantity in measured])
    missed = [quantity for quantity in measured if quantity.verdict() != HOLDS]
    if missed and not correction:
        correction = f"It is {missed[0].text(missed[0].best)}."
    return Statement(
        published,
        source,
        derived,
        found=[quantity.line() for quantity in measured] + list(also),
        holds=holds,
        correction=correction if missed else "",
    )


def _worst(verdicts: Sequence[str]) -> str:
    return max(verdicts, key=(HOLDS, CORRECTED, FAILS).index)
