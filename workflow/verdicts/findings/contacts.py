"""How hard beads of a material press on each other."""

from collections.abc import Iterator
from dataclasses import dataclass

from analysis.largest_overlap import LargestOverlap, shown_by_frames
from analysis.sharing.survey import Survey
from workflow.runs.contacts import Contacts as Hardest
from workflow.runs.contacts import has_contacts, of_overlap
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts.findings.finding import Finding, Measure


@dataclass(frozen=True)
class Contacts(Finding):
    """The hardest contact."""

    key, kind = "contacts", Hardest

    found: Hardest

    def said(self) -> Iterator[str]:
        """With a warning where Hertz's law ends."""
        yield from self.found.lines()

    @classmethod
    def measure(cls, directory: RunDirectory) -> Measure | None:
        """Of elastic spheres with a material; where frames do not show overlaps, what they may be at most."""
        problem = directory.problem
        if not has_contacts(directory):
            return None
        overlap = LargestOverlap()

        def finish(_: Survey) -> Contacts | None:
            hardest = of_overlap(directory.scene, overlap)
            return None if hardest is None else cls(problem, hardest)

        return Measure(finish, overlap.add) if shown_by_frames(problem) else Measure(finish)
