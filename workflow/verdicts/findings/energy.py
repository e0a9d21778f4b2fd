"""Where the energy was over time, where no pulse stays together."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis.sharing.energy_flow import EnergyFlow, Flow
from lammps_inputs.facts import Fact
from lammps_inputs.numbers import known
from workflow.runs.run_directory import RunDirectory
from workflow.screen import Table
from workflow.verdicts.findings.finding import MOST_CHAINS, Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Energy(Finding):
    """Shares of the chains."""

    key = "energy"

    flow: Flow

    def plain(self) -> dict[str, Any]:
        """Time in the scene's units.

        | key     | what                                                                                          |
        |---------|-----------------------------------------------------------------------------------------------|
        | time    | of some frames                                                                                |
        | share   | energy of each chain, but for springs to others, in that of all chains, [instant][chain]      |
        | between | energy in the springs between chains, over the energy input until then: kicks, work of pushes |
        |         | and drives; null where there was none                                                         |
        | centre  | mean number of the bead that has it; null where the chain has none                            |
        | spread  | its standard deviation                                                                        |
        """
        flow = self.flow
        return {
            "time": (flow.time * self.problem.scale.time).tolist(),
            "between": [known(value) for value in flow.between.tolist()],
            **{
                name: [[known(value) for value in row] for row in getattr(flow, name).tolist()]
                for name in ("share", "centre", "spread")
            },
        }

    def said(self) -> Iterator[Table]:
        """How much of it each chain had, and where along the chain, at the least, most and last."""
        flow, chains, scale = self.flow, self.problem.chains, self.problem.scale
        unit = f" ({scale.symbol('time')})" if scale.si else ""
        rows = []
        for chain in range(min(chains, MOST_CHAINS)):
            least, most = flow.extremes(chain)
            ends = [f"{share:.4f} at {when * scale.time:.5g}" for share, when in (least, most)]
            place = f"{flow.centre[-1, chain]:.1f} +- {flow.spread[-1, chain]:.1f}"
            rows.append([str(chain + 1), *ends, f"{flow.share[-1, chain]:.4f}", place])
        if chains > MOST_CHAINS:
            rows.append([f"of {chains}", "", "", "", ""])
        head = ["chain", f"least at time{unit}", f"most at time{unit}", "at the end", "there, around bead"]
        yield Table(f"{self.problem.name}: share of the energy", head, rows)

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """Over time."""
        from analysis.figures import energy_figure

        return {"energy": lambda: energy_figure(self.problem, self.flow)}


def measure(directory: RunDirectory) -> Measure | None:
    """Of all beads."""
    problem = directory.problem
    if not problem.whole or problem.holds(Fact.PULSE):
        return None
    flow = EnergyFlow(problem)
    return Measure(lambda _: Energy(problem, flow.result()), flow.add)
