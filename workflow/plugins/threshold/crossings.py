"""Brackets of the places where a quantity crosses a level, and the values to compute next.

Everything follows from the computed values, so an interrupted search is resumed. The range is first scanned at equal
distances. Between two neighbours of the scan on different sides of the level the bracket is halved until it is as
narrow as required. Then values on either side of it are computed, at distances that grow by factors of `APART`: where a
value is on the wrong side, as happens with a noisy quantity, the bracket includes it. A quantity that is undefined in
the middle of a bracket is computed at its quarters; where it is undefined at these, too, the bracket is not narrowed
further.
"""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

APART = 4.0
"""Ratio of the distances from a bracket at which its neighbourhood is checked."""

Computed = Mapping[float, float | None]
"""Value of the field -> quantity, None where it is undefined."""


@dataclass(frozen=True)
class SearchedField:
    """The values of a field that are searched.

    Attributes:
        low, high: ends of the range, both possible.
        log: whether distances are those of logarithms.
        integer: whether only whole numbers are possible.
        points: largest number of values of the scan.
        tolerance: required half-width of a bracket over its place.
    """

    low: float
    high: float
    log: bool = False
    integer: bool = False
    points: int = 9
    tolerance: float = 1e-3

    def scan(self) -> list[float]:
        """Values at equal distances, ascending, with both ends."""
        inner = [self._between(self.low, self.high, k / (self.points - 1)) for k in range(1, self.points - 1)]
        return sorted({self.low, *inner, self.high})

    def middle(self, low: float, high: float) -> float:
        """Half way between two values."""
        return math.sqrt(low * high) if self.log else 0.5 * (low + high)

    def is_narrow(self, low: float, high: float) -> bool:
        """Whether a bracket is as narrow as required."""
        if self.integer:
            return high - low <= 1.0
        return high - low <= 2.0 * self.tolerance * max(abs(low), abs(high), 1e-6 * (self.high - self.low))

    def inside(self, low: float, high: float) -> list[float]:
        """The middle of a bracket and its quarters, those that are not its ends."""
        values = dict.fromkeys(self._between(low, high, part) for part in (0.5, 0.25, 0.75))
        return [value for value in values if low < value < high]

    def around(self, low: float, high: float, within: tuple[float, float]) -> list[float]:
        """Values on either side of a bracket, at growing distances from it, within a wider bracket."""
        values, part = [], 1.0
        while part < 1e9:
            pair = [
                value
                for value in (self._between(low, high, -part), self._between(low, high, 1.0 + part))
                if within[0] < value < within[1]
            ]
            if not pair:
                break
            values += pair
            part *= APART
        return list(dict.fromkeys(values))

    def _between(self, low: float, high: float, part: float) -> float:
        value = low * (high / low) ** part if self.log else low + part * (high - low)
        return float(round(value)) if self.integer else value


@dataclass(frozen=True)
class Crossing:
    """A place where a quantity crosses a level.

    Attributes:
        low, high: all computed values of the field from the scan's neighbour up to ``low`` are on one side of the
            level, all from ``high`` to the next neighbour on the other.
        rises: whether the quantity is below the level at ``low``.
        slope: slope of the quantity over the field, between the neighbours in the scan.
        mixed: whether there are computed values on both sides of the level between ``low`` and ``high``.
        undefined: whether the quantity is undefined at a value between ``low`` and ``high``.
    """

    low: float
    high: float
    rises: bool
    slope: float
    mixed: bool
    undefined: bool


def wanted(computed: Computed, axis: SearchedField, level: float) -> list[float]:
    """Values of the field to compute next; none where the search has ended."""
    scan = [value for value in axis.scan() if value not in computed]
    if scan:
        return scan
    values: list[float] = []
    for pair in _brackets(computed, axis, level):
        low, high, following = _halved(computed, axis, level, pair)
        values += following or [value for value in axis.around(low, high, pair) if value not in computed]
    return values


def crossings(computed: Computed, axis: SearchedField, level: float) -> list[Crossing]:
    """Crossings of the level, once no further value is `wanted`."""
    return [_crossing(computed, pair, level) for pair in _brackets(computed, axis, level)]


def _brackets(computed: Computed, axis: SearchedField, level: float) -> Iterator[tuple[float, float]]:
    """Pairs of neighbours in the scan on different sides of the level; values where it is undefined are left out."""
    scan = [value for value in axis.scan() if computed[value] is not None]
    return ((a, b) for a, b in itertools.pairwise(scan) if _above(computed, a, level) != _above(computed, b, level))


def _above(computed: Computed, value: float, level: float) -> bool | None:
    quantity = computed[value]
    return None if quantity is None else quantity >= level


def _halved(
    computed: Computed, axis: SearchedField, level: float, pair: tuple[float, float]
) -> tuple[float, float, list[float]]:
    """Bracket after all halvings whose values are computed, and the value that the next halving needs, if any."""
    low, high = pair
    below = _above(computed, low, level)
    while not axis.is_narrow(low, high):
        for value in axis.inside(low, high):
            if value not in computed:
                return low, high, [value]
            side = _above(computed, value, level)
            if side is not None:
                low, high = (value, high) if side == below else (low, value)
                break
        else:
            break
    return low, high, []


def _crossing(computed: Computed, pair: tuple[float, float], level: float) -> Crossing:
    values = sorted(value for value in computed if pair[0] <= value <= pair[1])
    sides = [_above(computed, value, level) for value in values]
    first = next(k for k, side in enumerate(sides) if side != sides[0]) - 1
    last = len(sides) - next(k for k, side in enumerate(reversed(sides)) if side != sides[-1])
    between = sides[first + 1 : last]
    ends = [computed[value] or 0.0 for value in pair]
    return Crossing(
        low=values[first],
        high=values[last],
        rises=not sides[0],
        slope=(ends[1] - ends[0]) / (pair[1] - pair[0]),
        mixed=any(side is not None for side in between),
        undefined=None in between,
    )
