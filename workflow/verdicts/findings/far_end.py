"""What comes through to the far end of the chains."""

from dataclasses import dataclass
from typing import Any

from analysis.gauges.far_end import FarEnd as Collected
from lammps_inputs.numbers import known
from workflow.runs.engines import ENGINES
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure


@dataclass(frozen=True)
class FarEnd(Finding):
    """Its force, how late it comes, and the energy."""

    key = "far_end"

    numbers: dict[str, float]
    """Dimensionless (`analysis.gauges.far_end`)."""

    def plain(self) -> dict[str, Any]:
        """The same in the scene's units."""
        scale = self.problem.scale
        worth = {"wall_force": scale.force, "wall_force_chain": scale.force, "delay": scale.time}
        return {name: known(value * worth.get(name, 1.0)) for name, value in self.numbers.items()}


def measure(directory: RunDirectory) -> Measure | None:
    """Of all beads, if they are elastic."""
    problem = directory.problem
    if not problem.whole or not ENGINES[directory.engine].deforms:
        return None
    end = Collected(problem)
    return Measure(lambda _: FarEnd(problem, end.result()), end.add)
