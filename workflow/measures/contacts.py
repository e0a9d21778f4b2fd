"""The largest force in contacts of elastic spheres, and whether Hertz's law holds there."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

from analysis.contacts import OverlapMaxima, OverlapMeter, overlap_meter
from analysis.sharing.survey import Survey
from workflow.measures.measurement import Measurement, Recorded
from workflow.runs.contacts import LargestContactForce, has_contacts, of_overlap


@dataclass(frozen=True, repr=False)
class ContactMeasurement(Measurement):
    """The largest contact force."""

    key, kind = "contacts", LargestContactForce

    values: LargestContactForce

    def lines(self) -> Iterator[str]:
        """The largest force, with a warning where Hertz's law ends."""
        yield from self.values.lines()

    @classmethod
    def meter(cls, run: Recorded) -> OverlapMeter | None:
        """Overlaps of elastic spheres with a material, where frames show them."""
        return overlap_meter(run.problem) if has_contacts(run.scene, run.problem) else None

    @classmethod
    def of_run(cls, run: Recorded, survey: Survey, measured: OverlapMaxima | None) -> Self | None:
        """The largest contact force; where frames do not show overlaps, the largest possible one."""
        del survey
        force = of_overlap(run.scene, measured) if has_contacts(run.scene, run.problem) else None
        return None if force is None else cls(run.problem, force)
