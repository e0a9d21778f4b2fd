"""Harmonic drives: a bead that is moved to and fro, or pushed and pulled, for ever: a shaker, a piezo actuator."""

import math
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from pydantic import Field, model_validator

from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import OnBead, Positive
from lammps_inputs.laws.in_time import Sine
from lammps_inputs.loads import Load, Motion
from lammps_inputs.units import Unit

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene
    from lammps_inputs.system import System


class Drive(OnBead):
    """``displacement * (sin(2 pi frequency t + phase) - sin(phase))``, or a force ``force * sin(...)``, of one bead."""

    example: ClassVar[str] = "{displacement: 0.1, frequency: 0.05}"
    sources = ("coste1997",)

    key = "drive"

    displacement: Annotated[Positive, Unit("m")] | None = None
    """Amplitude of the prescribed displacement; or give `force`."""
    force: Annotated[Positive, Unit("N")] | None = None
    """Amplitude of the force on the bead; or give `displacement`."""
    frequency: Annotated[Positive, Unit("Hz")]
    """Frequency f, in cycles per unit time."""
    phase: Annotated[float, Field(ge=-360, le=360), Unit("degrees", always=True)] = 0.0
    """Phase; with -90 the bead starts at rest and moves towards higher bead numbers."""

    @model_validator(mode="after")
    def _one_of_the_two(self) -> Self:
        if (self.displacement is None) == (self.force is None):
            given = "neither is given" if self.force is None else "both are given"
            raise ValueError(f"displacement: give either displacement or force ({given})")
        return self

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse a bead outside the array, too, and what does not go with motion for ever."""
        super().refuse(scene)
        if scene.output.peaks:
            raise ValueError("output.peaks: finds the pulse that leads, which a drive makes none of; leave it out")
        if self.displacement is not None and any(
            (kick.chain, kick.bead) == (self.chain, self.bead) for kick in scene.kicks
        ):
            raise ValueError("drive.displacement: says how the bead moves, so it cannot be kicked; drive another bead")

    def refuse_system(self, scene: "BaseScene", system: "System") -> None:  # noqa: ARG002
        """Refuse what else would move a bead whose motion is given."""
        if self.displacement is None:
            return
        places = [(load.chain, load.bead) for load in system.loads]
        places += [(motion.chain, motion.bead) for motion in system.motions]
        if places.count((self.chain, self.bead)) > 1:
            raise ValueError(
                f"drive.displacement: bead {self.bead} of chain {self.chain} is moved or pushed otherwise, too; "
                "leave one of them out"
            )

    def lacks(self, scene: "BaseScene") -> frozenset[Fact]:  # noqa: ARG002
        """No pulse leads, and time matters; and what moves a bead takes up any momentum."""
        taken = {Fact.PULSE, Fact.FRONT, Fact.REVERSIBLE}
        return frozenset(taken if self.displacement is None else {*taken, Fact.MOMENTUM})

    def speed(self, mass: float) -> float:
        """Largest velocity of the bead's motion; of a free bead under the force, about its mean."""
        if self.displacement is not None:
            return self.displacement * self._omega
        return (self.force or 0.0) / (mass * self._omega)

    def loads(self, scene: "BaseScene") -> tuple[Load, ...]:
        """The force, dimensionless."""
        if self.force is None:
            return ()
        law = Sine(self.force / scene.scale.force, self._omega * scene.scale.time, math.radians(self.phase))
        return (Load(self.chain, self.bead, law),)

    def motions(self, scene: "BaseScene") -> tuple[Motion, ...]:
        """The motion, dimensionless."""
        if self.displacement is None:
            return ()
        amplitude, omega = self.displacement / scene.scale.length, self._omega * scene.scale.time
        return (Motion(self.chain, self.bead, amplitude, omega, math.radians(self.phase)),)

    @property
    def _omega(self) -> float:
        return 2.0 * math.pi * self.frequency
