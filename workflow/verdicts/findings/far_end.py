"""What arrives at the far end of the chains."""

from dataclasses import dataclass

from analysis.gauges.far_end import FarEnd as Collected
from analysis.gauges.far_end import Transmitted
from workflow.runs.engines import ENGINES
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure


@dataclass(frozen=True)
class FarEnd(Finding):
    """Force, delay and energy."""

    key, kind = "far_end", Transmitted

    found: Transmitted

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Of all beads, if they are elastic."""
        problem = directory.problem
        if not problem.whole or not ENGINES[directory.engine].deforms:
            return None
        end = Collected(problem)
        return Measure(lambda _: cls(problem, end.result()), end.add)
