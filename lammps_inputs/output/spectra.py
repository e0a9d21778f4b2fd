"""Beads whose spectra a scene wants; computed from the frames."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field, field_validator

from lammps_inputs import strict_yaml
from lammps_inputs.ingredients.base import Count, Part
from lammps_inputs.output.beads import each_once
from lammps_inputs.units import Unit

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene


class Spectra(Part):
    """Of the velocity of beads in every chain."""

    example: ClassVar[str] = "{beads: [1, 20]}"

    beads: tuple[Count, ...]
    """Beads whose spectra are computed; the others are compared with the first."""
    after: Annotated[float, Field(ge=0, le=1e30), Unit("s")] | None = None
    """Start of the analysed part of the record; half of the duration if omitted."""

    _from_list = field_validator("beads", mode="before")(strict_yaml.as_tuple)

    @field_validator("beads")
    @classmethod
    def _named(cls, value: Any) -> Any:
        return each_once(value)

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse beads that do not exist or are not recorded, and times after the end.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if scene.window is not None:
            raise ValueError("output.spectra: a window lets go of the beads behind it; leave one of them out")
        if max(self.beads) > scene.beads:
            raise ValueError(f"output.spectra.beads: {max(self.beads)} is outside the array (beads 1 to {scene.beads})")
        missing = [] if scene.output.beads == "all" else sorted(set(self.beads) - set(scene.output.beads))
        if missing:
            raise ValueError(
                f"output.spectra.beads: {', '.join(map(str, missing[:10]))} not recorded; add to output.beads"
            )
        if self.after is not None and scene.duration is not None and self.after >= scene.duration:
            raise ValueError(f"output.spectra.after: {self.after:g} is after the end at {scene.duration:g}")
