"""Tables and figures that are exported; what several formats need is computed once."""

from dataclasses import dataclass
from functools import cached_property

from granchain.parts import analyse, collect, panels
from workflow.plugins.export.request import ExportRequest

SWEEP = "table.csv"
"""Name of the table of a sweep, as ``granchain collect`` gives it."""


@dataclass(frozen=True)
class Results:
    """Tables and figures of a run, or the table of a sweep.

    Attributes:
        request: the run or the sweep.
    """

    request: ExportRequest

    @cached_property
    def _frames(self) -> analyse.MeasuredFrames:
        return analyse.measure(self.request.directory)

    @cached_property
    def tables(self) -> dict[str, str]:
        """Name -> text of each table as CSV."""
        return self._frames.tables if self.request.is_run else {SWEEP: collect.collect(self.request.path).to_csv()}

    @cached_property
    def figures(self) -> dict[str, panels.Sheet]:
        """Name -> panels of each figure of the run; a sweep has none."""
        return {name: make() for name, make in self._frames.figures.items()} if self.request.is_run else {}
