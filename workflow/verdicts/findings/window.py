"""Residual motion behind a window that follows the pulse."""

from collections.abc import Iterator
from dataclasses import dataclass

from analysis.tracking.behind_window import BehindWindow, Residual
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure


@dataclass(frozen=True)
class Window(Finding):
    """Whether it could catch up."""

    key, kind = "window", Residual

    found: Residual

    def said(self) -> Iterator[str]:
        """The sentence."""
        yield self.found.sentence

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Where there is a window."""
        problem = directory.problem
        if problem.window is None:
            return None
        behind = BehindWindow()
        return Measure(lambda found: cls(problem, behind.result(found.waves)), behind.add)
