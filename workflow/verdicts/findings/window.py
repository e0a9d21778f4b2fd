"""What a window that follows the pulse has left behind."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from analysis.tracking.leading_waves import Waves
from analysis.tracking.left_behind import LeftBehind
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure


@dataclass(frozen=True)
class Window(Finding):
    """Whether it could have come back."""

    key = "window"

    left: LeftBehind
    waves: Waves

    def plain(self) -> dict[str, Any]:
        """Velocities in V.

        | key          | what                                                                      |
        |--------------|---------------------------------------------------------------------------|
        | rows         | of the window                                                             |
        | left_behind  | largest velocity of a bead when it was left behind, and which ``bead``    |
        | slowest_wave | the lowest leading wave, which that must not exceed                       |
        | sentence     | whether it does, in words                                                 |
        """
        return {
            "rows": self.problem.window,
            "left_behind": self.left.velocity,
            "bead": self.left.bead,
            "slowest_wave": known(self.left.slowest_wave(self.waves)),
            "sentence": self.left.sentence(self.waves),
        }

    def said(self) -> Iterator[str]:
        """The sentence."""
        yield self.left.sentence(self.waves)


def measure(directory: RunDirectory) -> Measure | None:
    """Where there is a window."""
    problem = directory.problem
    if problem.window is None:
        return None
    left = LeftBehind()
    return Measure(lambda found: Window(problem, left, found.waves), left.add)
