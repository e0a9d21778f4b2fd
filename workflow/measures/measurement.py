"""A measurement of a run beside its waves: taken while frames pass, then written, printed and drawn.

Plug-ins take this module for measures of their own: a class from `Measurement`, declared in the entry points, has its
values, lines, table and figure; its `Meter` sees the frames of a run, which is `Recorded`.

Examples:
    >>> @quantity.result
    ... class Largest:
    ...     velocity: float = quantity.declare("largest velocity of any bead", "velocity")
    >>> class LargestVelocity(measurement.Measurement):
    ...     key, kind = "largest", Largest
    ...     def lines(self):
    ...         yield f"largest velocity {self.problem.scale.written(self.values.velocity, 'velocity')}"
    >>> [*LargestVelocity(granchain.load("two-chains-steel").problem(), Largest(0.5)).lines()]
    ['largest velocity 0.5 m/s']
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from analysis import quantity
from analysis.conservation import Conservation
from analysis.sharing.run_error import UNMEASURED, MeasuredError
from analysis.sharing.survey import Survey
from analysis.trajectory import Trajectory
from lammps_inputs import Problem, Scene
from workflow.runs.job import Job
from workflow.screen import PrintedTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_CHAINS = 8
"""Chains that a table shows."""


@dataclass(frozen=True)
class Recorded:
    """A run as meters see it, whether its frames are in a directory or in memory.

    Attributes:
        scene: what was run.
        problem: the dimensionless problem that it stands for.
        error: measured error of the run.
        job: record of the run; empty where its frames are in memory.
    """

    scene: Scene
    problem: Problem
    error: MeasuredError = UNMEASURED
    job: Job = field(default_factory=Job)


class Meter(ABC):
    """Receives every block of frames of a run, and makes the measurement at the end."""

    def add(self, block: Trajectory) -> None:
        """Take the next frames; by default nothing of them is needed."""
        del block

    @abstractmethod
    def finish(self, survey: Survey) -> "Measurement | None":
        """The measurement, with the waves, pulses and energies of the run; None where the frames do not show it."""


@dataclass(frozen=True, repr=False)
class Measurement:
    """A measured result of a run: its values, and the lines, the table and the figure that show them.

    A class has no lines, no table and no figure unless it overrides them.
    """

    key: ClassVar[str]
    """Key in ``analysis.json``."""

    kind: ClassVar[Any]
    """Type of ``values``, whose fields declare the quantities under the key."""

    table: ClassVar[tuple[str, Any] | None] = None
    """CSV file beside the frames, and type whose fields declare its columns."""

    figure: ClassVar[str] = ""
    """Name of the figure that it may draw; empty where there is none."""

    at_the_end: ClassVar[bool] = False
    """Whether it needs the pulse at the end of the chains, for which a run that ends at a bead before goes on."""

    problem: Problem

    values: Any
    """Values under the key in ``analysis.json``, dimensionless."""

    def __repr__(self) -> str:
        return f"<{self.key} of {self.problem.name}, in the scene's units: {self.plain()}>"

    def plain(self) -> Any:
        """Values in the scene's units, as plain data."""
        return quantity.plain(self.values, self.problem.scale)

    def lines(self) -> "Iterator[str | PrintedTable]":
        """Lines and tables that `analyze` prints."""
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
    def meter(cls, run: Recorded) -> Meter | None:
        """Meter of the frames of a run; None where the run has none of it, or it follows from other measurements."""
        del run
        return None

    @classmethod
    def of_frames(cls) -> bool:
        """Whether there are runs of whose frames a meter makes it."""
        return "meter" in vars(cls)

    @classmethod
    def of_energies(cls, run: Recorded, conservation: Conservation, between_frames: float) -> "Measurement | None":
        """Measurement that follows from the energies of all frames; None where the run has none of it.

        Args:
            run: the run.
            conservation: its energy over all frames.
            between_frames: uncertainty of what was exchanged between frames, in units of m V**2.
        """
        del run, conservation, between_frames
        return None
