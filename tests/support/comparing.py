"""What a file holds against what it should: leaf by leaf, each number with its own bound; what nobody computed is told.

An expectation is a tree like the data: dicts, lists, and leaves, which are plain values (equal), numbers `About`
others, claims (`Holds`), alternatives (`Either`), or functions of what was found (`Given`) that return a tree.
"""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

ROUNDED = 1e-9
"""Relative difference of what is computed from the same numbers in another order."""


@dataclass(frozen=True)
class About:
    """A number, within an absolute bound; null where it is None or not finite."""

    value: float | None
    within: float = 0.0

    def fits(self, found: Any) -> bool:
        if self.value is None or not math.isfinite(self.value):
            return found is None
        if not isinstance(found, int | float) or isinstance(found, bool):
            return False
        return abs(found - self.value) <= self.within + ROUNDED * abs(self.value) + 1e-300


@dataclass(frozen=True)
class Holds:
    """A claim on what was found."""

    claim: str
    of: Callable[[Any], bool]


@dataclass(frozen=True)
class Either:
    """Any of some trees."""

    options: tuple[Any, ...]


@dataclass(frozen=True)
class Given:
    """A tree that follows from what was found, for what identifies itself."""

    of: Callable[[Any], Any]


@dataclass(frozen=True)
class Unknown:
    """What the integrator here does not know itself, and why."""

    why: str


@dataclass
class Tally:
    """What was compared."""

    numbers: Counter[str] = field(default_factory=Counter)
    sentences: Counter[str] = field(default_factory=Counter)
    unchecked: Counter[str] = field(default_factory=Counter)
    unknown: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def add(self, other: "Tally") -> None:
        for name in ("numbers", "sentences", "unchecked", "unknown"):
            getattr(self, name).update(getattr(other, name))
        self.wrong += other.wrong

    def claim(self, name: str, *, holds: bool, what: str = "") -> None:
        """A sentence, or what a file lacks."""
        self.sentences[kind_of(name)] += 1
        if not holds:
            self.wrong.append(f"{name}: {what}" if what else name)

    def compare(self, path: str, found: Any, expected: Any) -> None:
        """All of found against what is expected."""
        if isinstance(expected, Given):
            self.compare(path, found, expected.of(found))
        elif isinstance(expected, Unknown):
            self.unknown[kind_of(path)] += 1
        elif isinstance(expected, Either):
            self._either(path, found, expected.options)
        elif isinstance(expected, dict):
            self._dict(path, found, expected)
        elif isinstance(expected, list | tuple):
            self._list(path, found, expected)
        else:
            self.numbers[kind_of(path)] += 1
            self._leaf(path, found, expected)

    def _either(self, path: str, found: Any, options: Iterable[Any]) -> None:
        tries = []
        for option in options:
            one = Tally()
            one.compare(path, found, option)
            tries.append(one)
        self.add(min(tries, key=lambda one: (len(one.wrong), len(one.unchecked))))

    def _dict(self, path: str, found: Any, expected: dict[str, Any]) -> None:
        if not isinstance(found, dict):
            self.wrong.append(f"{path}: {_short(found)} where keys {', '.join(expected)} are due")
            return
        for key, value in found.items():
            if key in expected:
                self.compare(f"{path}.{key}", value, expected[key])
            else:
                self._not_checked(f"{path}.{key}", value)
        for key in expected.keys() - found.keys():
            self.wrong.append(f"{path}.{key}: is missing")

    def _list(self, path: str, found: Any, expected: list[Any] | tuple[Any, ...]) -> None:
        if not isinstance(found, list) or len(found) != len(expected):
            size = len(found) if isinstance(found, list) else _short(found)
            self.wrong.append(f"{path}: {size} entries where {len(expected)} are due")
            return
        for place, (one, other) in enumerate(zip(found, expected, strict=True)):
            self.compare(f"{path}[{place}]", one, other)

    def _leaf(self, path: str, found: Any, expected: Any) -> None:
        if isinstance(expected, Holds):
            good, due = expected.of(found), expected.claim
        elif isinstance(expected, About):
            good, due = expected.fits(found), f"{_short(expected.value)} (to {expected.within:.1e})"
        else:
            good, due = found == expected and isinstance(found, bool) == isinstance(expected, bool), _short(expected)
        if not good:
            self.wrong.append(f"{path}: {_short(found)} where {due} is right")

    def _not_checked(self, path: str, value: Any) -> None:
        if isinstance(value, dict):
            for key, part in value.items():
                self._not_checked(f"{path}.{key}", part)
        elif isinstance(value, list) and value and isinstance(value[0], dict | list):
            for part in value:
                self._not_checked(f"{path}[]", part)
        else:
            self.unchecked[kind_of(path)] += 1


def kind_of(path: str) -> str:
    """A path without what counts its entries, and gauges and beads in headings."""
    return re.sub(r"(\[)\d+(\])|(?<=[a-z] )\d+", r"\1\2", path)


def column(values: Iterable[Any], within: Any = 0.0) -> list[About]:
    """Of numbers, each about its own."""
    values = list(values)
    bounds = list(within) if isinstance(within, Iterable) else [within] * len(values)
    return [About(float(value), float(bound)) for value, bound in zip(values, bounds, strict=True)]


def _short(value: Any) -> str:
    return f"{value:.8g}" if isinstance(value, float) else repr(value)[:80]
