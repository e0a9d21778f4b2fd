"""Static loads: forces that press the ends of the chains together, and gravity along them.

A loaded chain has a speed of sound, ``c0 = sqrt(k / m)`` beads a time with ``k = 3/2 A^(2/3) F0^(1/3)``, and solitary
waves on top of the load (Nesterenko, Dynamics of Heterogeneous Materials, 2001; Daraio, Nesterenko, Herbold & Jin,
Phys. Rev. E 73, 026610, 2006).
"""

from functools import partial
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, GetJsonSchemaHandler, model_serializer, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from lammps_inputs import physics
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients.base import Ingredient, Positive, Setting
from lammps_inputs.ingredients.unequal import masses_and_strengths, neighbours
from lammps_inputs.laws import has_state
from lammps_inputs.laws.weight import Weight
from lammps_inputs.layout import layout_of
from lammps_inputs.links import Links
from lammps_inputs.system import System
from lammps_inputs.units import Label, Unit


class _Load(Ingredient):
    """Ingredient that presses beads together at rest."""

    key: ClassVar[str]
    why: ClassVar[dict[Fact, str]] = {Fact.FRONT: "a window lets go of rows from which sound would come back"}

    def refuse(self, setting: Setting) -> None:
        """Refuse gaps, which no load leaves."""
        if np.any(setting.gap):
            raise ValueError(f"gap: beads under a static load touch; leave the gap or `{self.key}` out")

    def refuse_system(self, setting: Setting, system: System) -> None:  # noqa: ARG002
        """Refuse springs between chains that differ: they would be stretched at rest; and walls without number."""
        layout = layout_of(system)
        if physics.coupled(system) and not physics.even(system) and np.any(np.ptp(layout.places, axis=0) > 0.0):
            raise ValueError(
                f"{self.key}: chains that differ are compressed differently, which would stretch the springs between "
                "them; make the chains alike, or leave one out"
            )

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that do not hold where there is sound."""
        return frozenset({Fact.SONIC_VACUUM, Fact.FRONT})


class Precompression(_Load):
    """A constant force that presses the ends of every chain together; where there are walls, they hold it."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["force"]}, {"required": ["overlap"]}]})

    example: ClassVar[str] = "{force: 1}"
    sources = ("nesterenko2001", "daraio2006")

    key: ClassVar[str] = "precompression"

    force: Annotated[Annotated[Positive, Unit("N")] | None, Label("precompression", "F_0")] = None
    """Static force F0 at both ends of every chain; or give `overlap`."""
    overlap: Annotated[Annotated[Positive, Unit("m")] | None, Label("overlap by precompression", "\\delta_0")] = None
    """Overlap under F0 alone of contacts that are all alike, F0 = A overlap^p; in place of `force`."""

    @model_validator(mode="after")
    def _exactly_one(self) -> Self:
        if (self.force is None) == (self.overlap is None):
            given = "neither is given" if self.force is None else "both are given"
            raise ValueError(f"give either force or overlap ({given})")
        return self

    def refuse(self, setting: Setting) -> None:
        """Refuse also the overlap of contacts that differ, or of a force that is no power of it."""
        super().refuse(setting)
        if self.overlap is None:
            return
        ball = setting.material
        if ball is not None and self.overlap >= ball.radius:
            raise ValueError(
                f"precompression.overlap: {self.overlap:g} m is {self.overlap / ball.radius:.2g} times the radius, "
                f"where no contact is elastic; {self.overlap:g} mm is {1e-3 * self.overlap:g} m"
            )
        strength = masses_and_strengths(setting)[1]
        if np.ndim(strength):
            raise ValueError("precompression.overlap: the contacts differ, and so do their overlaps; give `force`")
        law = setting.law_between(strength, partial(neighbours, setting))
        if law is not None and (has_state(law) or law.overlap_under is None):
            raise ValueError("precompression.overlap: the force of the contacts is no power of it; give `force`")

    def static(self, setting: Setting, mass: float | NDArray[np.float64]) -> float | NDArray[np.float64]:  # noqa: ARG002
        """Force at rest, dimensionless: a number for all contacts; masses, [chain, bead], do not matter."""
        if self.overlap is None:
            assert self.force is not None
            return self.force / float(setting.scale.force)
        strength = masses_and_strengths(setting)[1]
        return np.asarray(strength * (self.overlap / setting.scale.length) ** setting.contact_scale[0])


class Gravity(_Load):
    """Acceleration towards higher bead numbers: a bead carries the weight of those before it, a wall that of all."""

    key: ClassVar[str] = "gravity"
    alone: ClassVar[str | None] = "acceleration"
    sources = ("hong1999",)

    acceleration: Annotated[Positive, Unit("m/s2"), Label("acceleration of gravity", "g")]
    """Acceleration towards higher bead numbers."""

    settled: bool = True
    """Whether the column is at rest under its weight at the start; false: the beads fall from places without load."""

    @model_validator(mode="before")
    @classmethod
    def _from_number(cls, value: Any) -> Any:
        return value if isinstance(value, dict | cls) else {"acceleration": value}

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler.resolve_ref_schema(handler(core_schema))
        number = {key: value for key, value in schema["properties"]["acceleration"].items() if key != "description"}
        keys = {key: schema[key] for key in ("type", "properties", "required", "additionalProperties")}
        return {"description": schema["description"], "anyOf": [number, keys]}

    @model_serializer
    def _as_number(self) -> float | dict[str, Any]:
        return self.acceleration if self.settled else {"acceleration": self.acceleration, "settled": False}

    def refuse(self, setting: Setting) -> None:
        """Refuse also a column that nothing holds, and of beads that fall what would be loaded or stretched at rest."""
        if not self.settled:
            for key in ("precompression", "foundation", "resonators"):
                if setting.part(key) is not None:
                    raise ValueError(f"gravity.settled: beads that fall have no rest with {key}; leave one out")
            return
        if np.any(setting.gap):
            raise ValueError(
                "gap: beads under a static load touch; leave the gap out, or let the beads fall: "
                f"`gravity: {{acceleration: {self.acceleration:g}, settled: false}}`"
            )
        super().refuse(setting)
        walls = setting.part("walls")
        if walls is None or not any(link.side > 0.0 for link in walls.links(setting)):
            raise ValueError("gravity: nothing holds the column; give `walls: {right: flat}` or another wall there")

    def refuse_system(self, setting: Setting, system: System) -> None:
        """Refuse also contacts of beads that fall whose force is no power of the overlap."""
        if self.settled:
            super().refuse_system(setting, system)
        elif any(link.law.overlap_under is None for link in system.along):
            raise ValueError("gravity.settled: falls are known for contacts whose force is a power of the overlap")

    def lacks(self, setting: Setting) -> frozenset[Fact]:
        """Facts that do not hold where there is sound; where beads fall, also those of a pulse and of momentum."""
        if self.settled:
            return super().lacks(setting)
        return frozenset({Fact.MOMENTUM, Fact.PULSE, Fact.REST, Fact.FRONT, Fact.SONIC_VACUUM})

    def links(self, setting: Setting) -> tuple[Links, ...]:
        """Weights of beads that fall; those of a settled column are a static load."""
        if self.settled:
            return ()
        law = Weight(self.acceleration / setting.scale.velocity * setting.scale.time, masses_and_strengths(setting)[0])
        return (Links.ground("gravity", law),)

    @property
    def stores(self) -> bool:
        """Whether beads fall."""
        return not self.settled

    def released(self, setting: Setting, system: System) -> float:  # noqa: ARG002
        """Speed of a fall through the gap and the overlap under the weight of a bead of mass 1."""
        return max(physics.fall_speeds(system), default=0.0)

    def static(self, setting: Setting, mass: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
        """Weight of the beads before each contact, dimensionless, [chain, bead + 1]; masses are [chain, bead]."""
        if not self.settled:
            return 0.0
        weight = self.acceleration * setting.scale.time**2 / setting.scale.length * np.asarray(mass)
        force = np.zeros((setting.chains, setting.beads + 1))
        force[:, 1:] = np.cumsum(np.broadcast_to(weight, (setting.chains, setting.beads)), axis=1)
        return force
