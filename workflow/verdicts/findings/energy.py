"""Energy over time: its budget where some is dissipated or supplied, and its shares where no pulse keeps its shape."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from analysis.conservation import ClosedAccount, Conservation
from workflow.engines.reference.energy_exchange import Accountant
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding

if TYPE_CHECKING:
    from matplotlib.figure import Figure
from typing import TYPE_CHECKING

from analysis.sharing.energies import EnergyFlow, Flow
from lammps_inputs.facts import Fact
from workflow.screen import Table
from workflow.verdicts.findings.finding import MOST_CHAINS, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Budget(Finding):
    """The account, and how well it is known."""

    key, kind, figure = "budget", ClosedAccount, "budget"

    found: ClosedAccount

    @property
    def sentence(self) -> str:
        """How well it is closed, in one line."""
        found = self.found
        own = "" if found.stated is None else f"; error of the run {found.stated:.1e} V"
        return (
            f"energy balance closed to {found.closed:.1e} of the energy input; exchange between frames uncertain by "
            f"{found.between_frames:.1e}{own}"
        )

    def said(self) -> Iterator[str]:
        """What went where, and how well that is known."""
        yield self.found.sentence(self.problem.scale)
        yield self.sentence

    @property
    def drawable(self) -> bool:
        """Over time, of more than one instant."""
        return len(self.found.time) > 1

    def draw(self) -> "Figure":
        """Over time."""
        from analysis.figures.energy import budget_figure

        return budget_figure(self.problem, self.found)


def closed(directory: RunDirectory, seen: Conservation, exchange: Accountant) -> Budget | None:
    """The budget of what was seen; None where nothing is exchanged, and where not all beads are recorded.

    Args:
        directory: the run.
        seen: its energy.
        exchange: what counted there what was exchanged.
    """
    if seen.budget is None:
        return None
    account = seen.budget.result()
    stated = directory.account.check or directory.account.uncertainty
    found = ClosedAccount(
        **vars(account),
        closed=seen.energy_drift,
        between_frames=exchange.uncertainty / account.most,
        stated=None if stated is None else stated.velocity,
    )
    return Budget(directory.problem, found)


@dataclass(frozen=True)
class Energy(Finding):
    """Shares of the chains."""

    key, kind, figure = "energy", Flow, "energy"

    found: Flow

    def said(self) -> Iterator[Table | str]:
        """How much of it each chain had, at the least, most and last, and where along the chain at the end."""
        flow, chains, scale = self.found, self.problem.chains, self.problem.scale
        if chains == 1:
            yield f"energy at the end: mean bead {flow.centre[-1, 0]:.1f}, standard deviation {flow.spread[-1, 0]:.1f}"
            return
        rows = []
        for chain in range(min(chains, MOST_CHAINS)):
            least, most = flow.extremes(chain)
            ends = [f"{share:.4f} at {when * scale.time:.5g}" for share, when in (least, most)]
            place = f"{flow.centre[-1, chain]:.1f} +- {flow.spread[-1, chain]:.1f}"
            rows.append([str(chain + 1), *ends, f"{flow.share[-1, chain]:.4f}", place])
        if chains > MOST_CHAINS:
            rows.append([f"of {chains}", "", "", "", ""])
        when = [scale.heading(f"{which} at time", "time") for which in ("least", "most")]
        head = ["chain", *when, "at the end", "there, around bead"]
        yield Table(f"{self.problem.name}: share of the energy", head, rows)
        if flow.fastest_mode_action is not None:
            yield f"share of the action in the fastest mode of the rows at the end: {flow.fastest_mode_action:.6f}"

    def draw(self) -> "Figure":
        """Over time."""
        from analysis.figures.energy import energy_figure

        return energy_figure(self.problem, self.found)

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Of all beads, where no pulse keeps its shape."""
        problem = directory.problem
        if not problem.whole or problem.system.holds(Fact.PULSE):
            return None
        flow = EnergyFlow(problem)
        return Measure(lambda _: cls(problem, flow.result()), flow.add)
