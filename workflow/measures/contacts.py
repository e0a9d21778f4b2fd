"""The largest force in contacts of elastic spheres, and whether Hertz's law holds there."""

from collections.abc import Iterator
from dataclasses import dataclass

from analysis.contacts import LargestOverlap, shown_by_frames
from analysis.sharing.survey import Survey
from analysis.trajectory import Trajectory
from workflow.measures.measurement import Measurement, Meter, Recorded
from workflow.runs.contacts import LargestContactForce, has_contacts, of_overlap


class ContactMeter(Meter):
    """Largest overlaps by the frames; where these do not show them, the largest possible ones."""

    def __init__(self, run: Recorded) -> None:
        self.run = run
        self._overlap = LargestOverlap()
        self._shown = shown_by_frames(run.problem)

    def add(self, block: Trajectory) -> None:
        """Take the next frames."""
        if self._shown:
            self._overlap.add(block)

    def finish(self, survey: Survey) -> "ContactMeasurement | None":
        """The largest contact force; None without a material."""
        del survey
        largest = of_overlap(self.run.scene, self._overlap)
        return None if largest is None else ContactMeasurement(self.run.problem, largest)


@dataclass(frozen=True, repr=False)
class ContactMeasurement(Measurement):
    """The largest contact force."""

    key, kind = "contacts", LargestContactForce

    values: LargestContactForce

    def lines(self) -> Iterator[str]:
        """The largest force, with a warning where Hertz's law ends."""
        yield from self.values.lines()

    @classmethod
    def meter(cls, run: Recorded) -> ContactMeter | None:
        """Contacts of elastic spheres with a material."""
        return ContactMeter(run) if has_contacts(run.scene, run.problem) else None
