"""A measurement of a run beside its waves: taken from frames, then written, printed and drawn.

Plug-ins take this module for measures of their own: a class from `Measurement`, declared in the entry points, has its
values, lines, table and figure, and chooses the `Meter` of a run, which is `Recorded`.

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

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

from analysis import quantity
from analysis.conservation import Conservation
from analysis.meters import Meter
from analysis.sharing.run_error import UNMEASURED, MeasuredError
from analysis.sharing.survey import Survey
from lammps_inputs import Problem, Scene
from workflow.runs.job import Job
from workflow.screen import PrintedTable

MOST_CHAINS = 8
"""Chains that a table shows."""


@dataclass(frozen=True)
class Recorded:
    """A run as measures see it, whether its frames are in a directory or in memory.

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

    def sheet(self) -> Any:
        """Panels of the figure, a `Sheet` of `analysis.figures.panels`; None where there is too little to draw."""
        return None

    @classmethod
    def meter(cls, run: Recorded) -> Meter[Any, Any] | None:
        """Meter of the frames of a run; None where the run has none of it, or it needs no frames."""
        del run
        return None

    @classmethod
    def of_frames(cls) -> bool:
        """Whether there are runs of whose frames a meter makes it."""
        return "meter" in vars(cls)

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: Any) -> Self | None:
        """Measurement of a run; None where the run has none of it.

        Args:
            run: the run.
            survey: its waves, pulses and energies.
            measured: result of the meter, by default the values themselves; None where there is no meter.
        """
        del survey
        return None if measured is None else cls(run.problem, measured)

    @classmethod
    def of_energies(cls, run: Recorded, conservation: Conservation, between_frames: float) -> Self | None:
        """Measurement that follows from the energies of all frames; None where the run has none of it.

        Args:
            run: the run.
            conservation: its energy over all frames.
            between_frames: uncertainty of what was exchanged between frames, in units of m V**2.
        """
        del run, conservation, between_frames
        return None
