"""Brackets of the places where a quantity crosses a level: which values to compute next, and what is known from them.

Everything follows from the values that are known, so a search that was interrupted continues where it was. The range is
first scanned at equal distances. Between two neighbours of the scan on different sides of the level the bracket is
halved until it is as narrow as asked for. Then values on either side of it are computed, at distances that grow by
factors of `APART`: where one is on the wrong side, as happens with a noisy quantity, the bracket includes it. A
quantity that is undefined in the middle of a bracket is computed at its quarters; where it is undefined there too, the
bracket stays as wide as it is.
"""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

APART = 4.0
"""Ratio of the distances from a bracket at which its neighbourhood is checked."""

Known = Mapping[float, float | None]
"""Value of the field -> quantity, None where it is undefined."""


@dataclass(frozen=True)
class SearchedField:
    """The values of a field that are searched.

    Attributes:
        low, high: ends of the range, both possible.
        log: whether distances are those of logarithms.
        whole: whether only whole numbers are possible.
        points: values of the scan, at most.
        tolerance: half-width of a bracket over its place at which it is narrow enough.
    """

    low: float
    high: float
    log: bool = False
    whole: bool = False
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
        """Whether a bracket is as narrow as asked for."""
        if self.whole:
            return high - low <= 1.0
        return high - low <= 2.0 * self.tolerance * max(abs(low), abs(high), 1e-6 * (self.high - self.low))

    def inside(self, low: float, high: float) -> list[float]:
        """The middle of a bracket and its quarters, those that are not its ends."""
        found = dict.fromkeys(self._between(low, high, part) for part in (0.5, 0.25, 0.75))
        return [value for value in found if low < value < high]

    def around(self, low: float, high: float, within: tuple[float, float]) -> list[float]:
        """Values on either side of a bracket, ever farther from it, within a wider one."""
        found, part = [], 1.0
        while part < 1e9:
            pair = [
                value
                for value in (self._between(low, high, -part), self._between(low, high, 1.0 + part))
                if within[0] < value < within[1]
            ]
            if not pair:
                break
            found += pair
            part *= APART
        return list(dict.fromkeys(found))

    def _between(self, low: float, high: float, part: float) -> float:
        value = low * (high / low) ** part if self.log else low + part * (high - low)
        return float(round(value)) if self.whole else value


@dataclass(frozen=True)
class Crossing:
    """A place where a quantity crosses a level.

    Attributes:
        low, high: all computed values of the field from the scan's neighbour up to ``low`` are on one side of the
            level, all from ``high`` to the next neighbour on the other.
        rises: whether the quantity is below the level at ``low``.
        slope: of the quantity over the field, between the neighbours in the scan.
        mixed: whether there are computed values on both sides of the level between ``low`` and ``high``.
        undefined: whether the quantity is undefined at a value between ``low`` and ``high``.
    """

    low: float
    high: float
    rises: bool
    slope: float
    mixed: bool
    undefined: bool


def wanted(known: Known, axis: SearchedField, level: float) -> list[float]:
    """Values of the field to compute next; none where the search has ended."""
    scan = [value for value in axis.scan() if value not in known]
    if scan:
        return scan
    found: list[float] = []
    for pair in _brackets(known, axis, level):
        low, high, following = _halved(known, axis, level, pair)
        found += following or [value for value in axis.around(low, high, pair) if value not in known]
    return found


def crossings(known: Known, axis: SearchedField, level: float) -> list[Crossing]:
    """Result once no further value is `wanted`."""
    return [_crossing(known, pair, level) for pair in _brackets(known, axis, level)]


def _brackets(known: Known, axis: SearchedField, level: float) -> Iterator[tuple[float, float]]:
    """Neighbours in the scan, of those where the quantity is defined, on different sides of the level."""
    scan = [value for value in axis.scan() if known[value] is not None]
    return ((a, b) for a, b in itertools.pairwise(scan) if _above(known, a, level) != _above(known, b, level))


def _above(known: Known, value: float, level: float) -> bool | None:
    found = known[value]
    return None if found is None else found >= level


def _halved(
    known: Known, axis: SearchedField, level: float, pair: tuple[float, float]
) -> tuple[float, float, list[float]]:
    """The bracket after all halvings whose values are known, and the value that the next one needs, if any."""
    low, high = pair
    below = _above(known, low, level)
    while not axis.is_narrow(low, high):
        for value in axis.inside(low, high):
            if value not in known:
                return low, high, [value]
            side = _above(known, value, level)
            if side is not None:
                low, high = (value, high) if side == below else (low, value)
                break
        else:
            break
    return low, high, []


def _crossing(known: Known, pair: tuple[float, float], level: float) -> Crossing:
    values = sorted(value for value in known if pair[0] <= value <= pair[1])
    sides = [_above(known, value, level) for value in values]
    first = next(k for k, side in enumerate(sides) if side != sides[0]) - 1
    last = len(sides) - next(k for k, side in enumerate(reversed(sides)) if side != sides[-1])
    between = sides[first + 1 : last]
    ends = [known[value] or 0.0 for value in pair]
    return Crossing(
        low=values[first],
        high=values[last],
        rises=not sides[0],
        slope=(ends[1] - ends[0]) / (pair[1] - pair[0]),
        mixed=any(side is not None for side in between),
        undefined=None in between,
    )
