"""The energy over time where some is lost or put in: it follows from the same account as the drift of the energy."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from analysis.conservation import ClosedAccount, Conservation
from workflow.engines.reference.accountant import Accountant
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Budget(Finding):
    """The account, and how well it is known."""

    key, kind, figures = "budget", ClosedAccount, ("budget",)

    found: ClosedAccount

    @property
    def sentence(self) -> str:
        """How well it is closed, in one line."""
        found = self.found
        own = "" if found.stated is None else f"; the run is right to {found.stated:.1e} V"
        return (
            f"budget closed to {found.closed:.1e} of what was put in; what happened between frames is known to "
            f"{found.between_frames:.1e} of it{own}"
        )

    def said(self) -> Iterator[str]:
        """What went where, and how well that is known."""
        yield self.found.sentence(self.problem.scale)
        yield self.sentence

    def drawn(self) -> "dict[str, Callable[[], Figure]]":
        """Over time."""
        from analysis.figures import budget_figure

        return {"budget": lambda: budget_figure(self.problem, self.found)} if len(self.found.time) > 1 else {}


def closed(directory: RunDirectory, seen: Conservation, ledger: Accountant) -> Budget | None:
    """The budget of what was seen; None where nothing is exchanged, and where not all beads are recorded.

    Args:
        directory: the run.
        seen: its energy.
        ledger: what counted there what was exchanged.
    """
    if seen.budget is None:
        return None
    account = seen.budget.result()
    stated = directory.account.check or directory.account.certificate
    found = ClosedAccount(
        **vars(account),
        closed=seen.energy_drift,
        between_frames=ledger.unsure / account.most,
        stated=None if stated is None else stated.velocity,
    )
    return Budget(directory.problem, found)
