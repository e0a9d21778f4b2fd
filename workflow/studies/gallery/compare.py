"""A published number beside the engines' own, with a verdict."""

from collections.abc import Callable, Mapping

from workflow.studies.gallery.entry import Runs
from workflow.studies.gallery.ran import Ran
from workflow.studies.page import CORRECTED, FAILS, HOLDS, Statement

NAMES = {"lammps": "LAMMPS", "reference": "reference"}


def each(runs: Runs, measure: Callable[[Ran], float]) -> dict[str, float]:
    """A quantity by engine."""
    return {engine: measure(run) for engine, run in runs.items()}


def number(
    says: str,
    published: float,
    found: Mapping[str, float],
    *,
    within: float,
    roughly: float = 0.0,
    correction: str = "",
    unit: str = "",
    digits: int = 5,
) -> Statement:
    """A number that was published.

    Args:
        says: the published statement.
        published: its number.
        found: the same by engine.
        within: how far the number may be off, as it was rounded or claimed.
        roughly: how far a number that holds with a correction may be off.
        correction: what to say where it is farther off than ``within``; by default the number found.
        unit: of the numbers.
        digits: after the point.
    """
    best = found["reference"]
    holds = (
        HOLDS if _all_near(found, published, within) else CORRECTED if _all_near(found, published, roughly) else FAILS
    )
    unit = f" {unit}" if unit else ""
    lines = engines(found, unit, digits)
    lines.append(f"{best - published:+.1e}{unit} from what was published ({best / published - 1.0:+.2%})")
    return Statement(says, lines, holds, "" if holds == HOLDS else correction or f"It is {best:.{digits}f}{unit}.")


def _all_near(found: Mapping[str, float], published: float, within: float) -> bool:
    """Whether every engine's number is as near as that; one that is not defined is not."""
    return all(abs(value - published) <= within for value in found.values())


def engines(found: Mapping[str, float], unit: str = "", digits: int = 5, label: str = "") -> list[str]:
    """A line with a quantity as each engine has it, and how far they are apart."""
    values = ", ".join(f"{NAMES[engine]} {value:.{digits}f}{unit}" for engine, value in found.items())
    apart = max(found.values()) - min(found.values())
    return [f"{label}{values}" + (f"; {apart:.0e} apart" if len(found) > 1 else "")]


def claim(says: str, lines: list[str], holds: bool, correction: str = "", *, partly: bool = False) -> Statement:
    """A statement without a number of its own; partly: whether what is not true of it is but a correction."""
    return Statement(says, lines, HOLDS if holds else CORRECTED if partly else FAILS, "" if holds else correction)
