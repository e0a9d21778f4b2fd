"""The energy over time where some is lost or put in: it follows from the same account as the drift of the energy."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis.budget import Account
from analysis.conservation import Conservation
from lammps_inputs import InputError
from lammps_inputs.numbers import known
from workflow.engines.reference.accountant import Accountant
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Budget(Finding):
    """The account, and how well it is known.

    Attributes:
        account: where it is, what was lost, and what was put in.
        missing: largest of it that is nowhere, in shares of the most that was put in.
        unsure: how well it is known what was lost and put in between frames, likewise.
        stated: error of the velocities that the run states, in units of V; None where it states none.
    """

    key = "budget"

    account: Account
    missing: float
    unsure: float
    stated: float | None

    @property
    def sentence(self) -> str:
        """How well it is closed, in one line."""
        own = "" if self.stated is None else f"; the run is right to {self.stated:.1e} V"
        return (
            f"budget closed to {self.missing:.1e} of what was put in; what happened between frames is known to "
            f"{self.unsure:.1e} of it{own}"
        )

    def plain(self) -> dict[str, Any]:
        """In the scene's units.

        | key       | what                                                                                        |
        |-----------|---------------------------------------------------------------------------------------------|
        | time      | of some frames                                                                              |
        | put_in    | until then, by kicks and by forces from outside                                             |
        | kinetic, contacts, springs, ground, walls | where it is                                                 |
        | lost      | until then, in each kind of dashpots                                                        |
        | missing   | what was put in and is nowhere                                                              |
        | closed    | largest of that in any frame, in the most that was put in                                   |
        | between_frames | how well it is known what was exchanged between frames, likewise                       |
        | stated    | error of the velocities that the run states, in V; null where it states none                |
        """
        return {
            **self.account.plain(self.problem.scale),
            "closed": known(self.missing),
            "between_frames": known(self.unsure),
            "stated": self.stated,
        }

    def said(self) -> Iterator[str]:
        """What went where, and how well that is known."""
        yield self.account.sentence(self.problem.scale)
        yield self.sentence

    def figures(self) -> "dict[str, Callable[[], Figure]]":
        """Over time."""
        from analysis.figures import budget_figure

        return {"budget": lambda: budget_figure(self.problem, self.account)} if len(self.account.time) > 1 else {}


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
    try:
        record = directory.record
    except InputError:
        record = {}
    stated = (record.get("check") or record.get("certificate") or {}).get("velocity")
    return Budget(directory.problem, account, seen.energy_drift, ledger.unsure / account.most, stated)
