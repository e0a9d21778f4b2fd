"""The rule by which a statement of the gallery holds, holds with a correction, or does not hold."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from workflow.study_kit.page import CORRECTED, FAILS, HOLDS, Statement

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
    """Where a quantity is required to lie, and, for a statement that needs a correction only, the wider range."""

    least: float
    most: float
    wide_least: float
    wide_most: float

    def verdict(self, value: float) -> str:
        """On one number; NaN is in no range."""
        if self.least <= value <= self.most:
            return HOLDS
        return CORRECTED if self.wide_least <= value <= self.wide_most else FAILS

    def text(self, unit: str) -> str:
        """In words, such as ``0.682 ± 0.0005 V (± 0.001 V)``."""
        said, wide = _interval(self.least, self.most, unit), _interval(self.wide_least, self.wide_most, unit)
        return said if wide == said else f"{said} ({wide[wide.find('±') :] if '±' in wide else wide})"


def _interval(least: float, most: float, unit: str) -> str:
    if math.isinf(least):
        return "any value" if math.isinf(most) else f"≤ {most:g}{unit}"
    if math.isinf(most):
        return f"≥ {least:g}{unit}"
    value = 0.5 * (least + most)
    return f"{value:g} ± {most - value:.2g}{unit}" if most > least else f"{value:g}{unit}"


def near(value: float, within: float, wider: float = 0.0) -> RequiredRange:
    """Within a distance of a value."""
    wider = max(within, wider)
    return RequiredRange(value - within, value + within, value - wider, value + wider)


def at_most(bound: float, wider: float | None = None) -> RequiredRange:
    """Not above a bound."""
    return RequiredRange(-math.inf, bound, -math.inf, bound if wider is None else wider)


def at_least(bound: float, wider: float | None = None) -> RequiredRange:
    """Not below a bound."""
    return RequiredRange(bound, math.inf, bound if wider is None else wider, math.inf)


@dataclass(frozen=True)
class MeasuredQuantity:
    """A quantity and the range that it is required to lie in.

    Attributes:
        what: the quantity, in words.
        found: its value by engine.
        required: the range.
        form: digits after the point, with ``e`` those of an exponential, and the unit, such as ``3 beads``.
    """

    what: str
    found: Mapping[str, float]
    required: RequiredRange
    form: str = "5"

    @property
    def _unit(self) -> str:
        return " " * (" " in self.form) + self.form.partition(" ")[2]

    @property
    def best(self) -> float:
        """Its value by the reference, or the first one where the reference did not run."""
        return self.found.get("reference", next(iter(self.found.values())))

    def text(self, value: float) -> str:
        """A value with its unit."""
        digits = self.form.partition(" ")[0]
        return f"{value:.{digits}}{self._unit}" if digits.endswith("e") else f"{value:.{digits}f}{self._unit}"

    def line(self) -> str:
        """What was found, by how much the engines differ, what is required, and the deviation from that."""
        said = f"{self.what}: " + ", ".join(
            f"{NAMES[name]} {self.text(value)}" if name in NAMES else f"{name}: {self.text(value)}"
            for name, value in self.found.items()
        )
        if set(self.found) == set(NAMES):
            said += f" (they differ by {max(self.found.values()) - min(self.found.values()):.0e})"
        said += f"; required: {self.required.text(self._unit)}"
        value = 0.5 * (self.required.least + self.required.most)
        if not math.isfinite(value) or self.required.least == self.required.most or not value:
            return said
        return f"{said}; deviation {self.best - value:+.1e}{self._unit} ({self.best / value - 1.0:+.2%})"

    def verdict(self) -> str:
        """By the worst engine."""
        return _worst([self.required.verdict(value) for value in self.found.values()])


def by_engine(found: Mapping[str, Value], text: Callable[[Value], str], before: str = "") -> list[str]:
    """Lines of what was found by each engine."""
    return [f"{before}{NAMES[engine]}: {text(value)}" for engine, value in found.items()]


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
        measured: what it is reduced to.
        published: the claim, as the source has it.
        source: key of the bibliography, and the place in it: ``rosas2007, abstract``.
        derived: what follows from it, or from theory, before anything is run.
        correction: what to say instead where it does not hold as it is; by default the first value out of its range.
        also: further lines of what was found.
    """
    holds = _worst([one.verdict() for one in measured])
    missed = [one for one in measured if one.verdict() != HOLDS]
    if missed and not correction:
        correction = f"It is {missed[0].text(missed[0].best)}."
    return Statement(
        published,
        source,
        derived,
        found=[one.line() for one in measured] + list(also),
        holds=holds,
        correction=correction if missed else "",
    )


def _worst(verdicts: Sequence[str]) -> str:
    return max(verdicts, key=(HOLDS, CORRECTED, FAILS).index)
