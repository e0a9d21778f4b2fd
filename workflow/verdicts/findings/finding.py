"""What some runs show beside their waves: measured while frames pass, then written, printed and drawn."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from analysis import quantity
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, Scene
from workflow.screen import PrintedTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_CHAINS = 8
"""Chains that a table shows."""


@dataclass(frozen=True)
class Recorded:
    """A run as measures see it, whether its frames are in a directory or in memory.

    Attributes:
        scene: what was run.
        problem: the dimensionless problem that it stands for.
        deforms: whether beads have overlaps and forces, as those of all engines but that of rigid beads.
        amplitude_error: measured error of peak velocities, in units of V; 0 where it was not measured.
    """

    scene: Scene
    problem: Problem
    deforms: bool = True
    amplitude_error: float = 0.0


@dataclass(frozen=True, repr=False)
class Finding:
    """Something that was found in a run; what is not overridden, there is none of."""

    key: ClassVar[str]
    """Of ``analysis.json``."""

    kind: ClassVar[Any]
    """Type of ``found``, whose fields declare the quantities under the key."""

    table: ClassVar[tuple[str, Any] | None] = None
    """CSV file beside the frames, and type whose fields declare its columns."""

    figure: ClassVar[str] = ""
    """Name of the figure that it may draw; empty where there is none."""

    needs_survey: ClassVar[bool] = True
    """Whether it follows from the pulses of the run, too, and not from the frames alone."""

    problem: Problem

    found: Any
    """What ``analysis.json`` says under the key, dimensionless."""

    def __repr__(self) -> str:
        return f"<{self.key} of {self.problem.name}, in the scene's units: {self.plain()}>"

    def plain(self) -> Any:
        """What was found, in the scene's units."""
        return quantity.plain(self.found, self.problem.scale)

    def said(self) -> "Iterator[str | PrintedTable]":
        """What `analyze` prints: lines and tables."""
        yield from ()

    def rows(self) -> Any:
        """What the table holds, of the type that declares its columns; None where there is none."""
        return None

    @property
    def drawable(self) -> bool:
        """Whether there is enough to draw."""
        return bool(self.figure)

    def draw(self) -> "Figure":
        """The figure, where it is drawable."""
        raise NotImplementedError

    @classmethod
    def measure(cls, run: Recorded) -> "Measure | None":
        """What to measure in a run; None where it has none of it, or it follows from what is measured of every run."""
        del run
        return None


def _ignore(block: Trajectory, /) -> None:
    """See nothing of the frames."""


@dataclass(frozen=True)
class Measure:
    """What is given every block of frames, and says in the end what was found, if anything was."""

    finish: Callable[[Any], Finding | None]
    """What was found, from the `Survey` of the run; from None for a kind that needs none."""
    add: Callable[[Trajectory], None] = _ignore
