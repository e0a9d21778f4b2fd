"""Contacts that have yielded: permanent overlaps and largest forces along the chains."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from analysis.contacts import Yielded, YieldMeter, YieldTable
from analysis.sharing.survey import Survey
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PlasticContacts(Finding):
    """What the contacts keep at the end."""

    key, kind, figure = "plastic", Yielded, "plastic"
    table = "plastic.csv", YieldTable

    found: Yielded
    contacts: YieldTable

    def said(self) -> Iterator[str]:
        """How many have yielded, by how much, and how the largest force falls along the kicked chain."""
        found, scale = self.found, self.problem.scale
        line = (
            f"plastic contacts: {found.contacts} of {len(self.contacts.contact)} have a permanent overlap, at most "
            f"{scale.written(found.permanent, 'length')}"
        )
        if math.isfinite(found.decay):
            line += f"; the largest force falls as n^{found.decay:.3f} with the number n of the contact"
        yield line

    def rows(self) -> YieldTable:
        """Each contact."""
        return self.contacts

    @property
    def drawable(self) -> bool:
        """Where any contact has been closed."""
        return bool((self.contacts.overlap > 0.0).any())

    def draw(self) -> "Figure":
        """Along the chains."""
        from analysis.figures.forces import yield_figure

        return yield_figure(self.problem, self.contacts)

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Of all beads."""
        problem = directory.problem
        if not problem.memory_columns or not hasattr(problem.system.along[0].law, "permanent"):
            return None
        meter = YieldMeter()

        def finish(_: Survey) -> PlasticContacts | None:
            found = meter.result()
            return None if found is None else cls(problem, *found)

        return Measure(finish, meter.add)
