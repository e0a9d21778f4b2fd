"""What some runs tell beside their waves: measured while frames pass, then told, written and drawn."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from analysis.sharing.survey import Survey
from analysis.trajectory import Trajectory
from lammps_inputs import Problem
from workflow.screen import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_CHAINS = 8
"""Chains that a table shows."""


@dataclass(frozen=True)
class Finding:
    """Something that was found in a run; what is not overridden, there is none of."""

    key: ClassVar[str]
    """Of ``analysis.json``."""

    problem: Problem

    def plain(self) -> Any:
        """What ``analysis.json`` says under the key, in the scene's units."""
        raise NotImplementedError

    def said(self) -> "Iterator[str | Table]":
        """What `analyze` prints: lines and tables."""
        yield from ()

    def tables(self) -> dict[str, str]:
        """CSV files beside the frames: name -> text."""
        return {}

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """Name -> what draws it; both are in `workflow.runs.files`, too."""
        return {}


def _look_away(block: Trajectory, /) -> None:
    """See nothing of the frames."""


@dataclass(frozen=True)
class Measure:
    """What sees every block of frames, and says in the end what was found, if anything was."""

    finish: Callable[[Survey], Finding | None]
    add: Callable[[Trajectory], None] = _look_away
