"""Forces that a scene wants read, as walls and sensors in a chain read them; computed from the frames, never dumped."""

from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import field_validator

from lammps_inputs import physics, strict_yaml
from lammps_inputs.ingredients.base import Count, Part
from lammps_inputs.output.beads import each_once

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene


class Forces(Part):
    """Where force is read, in every chain."""

    example: ClassVar[str] = "{contacts: [10]}"

    wall: Literal[True] | None = None
    """Forces on the walls."""
    contacts: tuple[Count, ...] | None = None
    """Force between bead n and bead n + 1, for each n in the list; in damped contacts with the dashpot's."""
    sensors: tuple[Count, ...] | None = None
    """Force inside bead n: the mean of its two contacts, as an embedded sensor measures it."""

    _from_list = field_validator("contacts", "sensors", mode="before")(strict_yaml.as_tuple)

    @field_validator("contacts", "sensors")
    @classmethod
    def _ascending(cls, value: Any) -> Any:
        return None if value is None else tuple(sorted(each_once(value, ", or leave it out")))

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse places that do not exist, or whose beads are not recorded.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        beads, recorded = scene.beads, scene.output.beads
        needed: dict[str, list[int]] = {}
        if self.wall is None and self.contacts is None and self.sensors is None:
            raise ValueError("output.forces: name wall: true, contacts or sensors")
        if scene.window is not None:
            raise ValueError("output.forces: a window lets go of the beads behind it; leave one of them out")
        if self.wall:
            walls = [link.law for link in physics.walls(scene.system)]
            if not walls:
                raise ValueError("output.forces.wall: the chains have no wall; name one in walls, or leave this out")
            needed["wall"] = [beads if law.side > 0.0 else 1 for law in walls]
        for bead in self.contacts or ():
            if bead > beads - 1:
                raise ValueError(f"output.forces.contacts: bead {bead} has no next one (beads 1 to {beads - 1} have)")
            needed.setdefault("contacts", []).extend((bead, bead + 1))
        for bead in self.sensors or ():
            if not 2 <= bead <= beads - 1:
                raise ValueError(
                    f"output.forces.sensors: bead {bead} has no bead on either side (beads 2 to {beads - 1} have)"
                )
            needed.setdefault("sensors", []).extend((bead - 1, bead, bead + 1))
        if recorded != "all":
            for key, wanted in needed.items():
                missing = sorted(set(wanted) - set(recorded))
                if missing:
                    names = ", ".join(map(str, missing[:10]))
                    raise ValueError(f"output.forces.{key}: needs beads {names} too; add them to output.beads")
