"""Parameters at the top of a deck: their values for a scene, and those that LAMMPS states in its log.

``-var NAME VALUE`` on LAMMPS's command line replaces a value of the deck, so that a run may be of another scene than
the one beside it.
"""

import math
import re
from collections.abc import Iterable

from lammps_inputs import file_names, scheme
from lammps_inputs.decks import deck
from lammps_inputs.problem import Problem

FREE = ("steps", "thermo")
"""Parameters that change no frame: how far a run goes, and how often the log has a line."""

SAME = 1e-9
"""Largest relative difference of a value from the scene's."""

_OF_DECK = re.compile(r"variable (\S+) index (\S+)")
_IN_LOG = re.compile(r"^Variable\[ *\d+\]: *(\S+?), *style = index, *def = *(\S+) *$", re.MULTILINE)


def of_problem(problem: Problem) -> dict[str, float]:
    """Value of each parameter of the deck of a problem, by name, without those that are `FREE`."""
    lines = [*deck.number_lines(problem), *deck.kick_lines(problem), *scheme.variable_lines(problem.scheme)]
    return {name: float(value) for name, value in _pairs(map(_OF_DECK.match, lines)) if name not in FREE}


def differences(log: str, problem: Problem) -> list[str]:
    """Texts on the parameters that LAMMPS's log states with values other than a problem's; none where all agree.

    Args:
        log: text of the log, of one run or of several, one after the other.
        problem: of the scene.

    Returns:
        One text a parameter, such as ``kick1: 0.9, in the scene 1``.
    """
    stated = _pairs(_IN_LOG.finditer(log))
    if not stated:
        return []
    expected, scale = of_problem(problem), problem.scale
    different = {
        name: f"{name}: {value}, in the scene {expected[name]:.9g}"
        for name, value in stated
        if name in expected and not math.isclose(_number(value), expected[name], rel_tol=SAME)
    }
    texts = list(different.values())
    if texts and not scale.length == scale.time == scale.mass == 1.0:
        texts[-1] += f" (dimensionless, as in {file_names.DECK})"
    return texts


def _pairs(matches: Iterable[re.Match[str] | None]) -> list[tuple[str, str]]:
    """Name and value of each match."""
    return [(match[1], match[2]) for match in matches if match is not None]


def _number(text: str) -> float:
    """Number that a text is for LAMMPS; NaN where it is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan
