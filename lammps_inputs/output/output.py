"""What is recorded of a run, and how often."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import field_validator

from lammps_inputs import strict_yaml
from lammps_inputs.ingredients.base import Count, Part, Positive
from lammps_inputs.output.beads import each_once
from lammps_inputs.output.forces import Forces
from lammps_inputs.output.spectra import Spectra
from lammps_inputs.units import Unit

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene


class Output(Part):
    """What is recorded, and how often."""

    example: ClassVar[str] = "{every: 0.1}"

    every: Annotated[Positive, Unit("s")] | None = None
    """Time between frames; 0.1 T if omitted."""
    beads: Literal["all"] | tuple[Count, ...] = "all"
    """Recorded beads of every chain."""
    snapshots: Annotated[Positive, Unit("s")] | None = None
    """Time between snapshots of all beads, in addition to the frames of the recorded ones."""
    peaks: Literal[True] | None = None
    """Find the leading pulse at every bead during a local run of LAMMPS, from all beads at the times of the frames."""
    forces: Forces | None = None
    """Where forces are evaluated."""
    spectra: Spectra | None = None
    """Beads whose velocity spectra are computed."""

    _from_list = field_validator("beads", mode="before")(strict_yaml.as_tuple)

    @field_validator("beads")
    @classmethod
    def _ascending(cls, value: Any) -> Any:
        return value if value == "all" else tuple(sorted(each_once(value, ", or `all`")))

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse what the scene does not have, and what needs more to be recorded.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """
        if self.beads != "all" and self.beads[-1] > scene.beads:
            raise ValueError(f"output.beads: {self.beads[-1]} is outside the array (beads 1 to {scene.beads})")
        if self.forces is not None:
            self.forces.refuse(scene)
        if self.spectra is not None:
            self.spectra.refuse(scene)

    def refuse_times(self, every: float, duration: float | None) -> None:
        """Refuse snapshots that do not fit in with frames so far apart.

        Raises:
            ValueError: as `refuse`.
        """
        if self.snapshots is None:
            return
        frames = self.snapshots / every
        if duration is not None and frames * every > duration * (1.0 + 1e-9):
            raise ValueError(f"output.snapshots: {frames * every:g} is longer than the duration of {duration:g}")
        if self.beads == "all":
            raise ValueError("output.snapshots: every frame holds all beads already; name some in output.beads")
        if round(frames) < 1 or abs(round(frames) / frames - 1.0) > 1e-9:
            raise ValueError(
                f"output.snapshots: is {frames:g} times output.every = {every:g}; a whole number of times is needed"
            )
