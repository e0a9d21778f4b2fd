"""How large a run may be that starts without a question: its frames, and the time that it is estimated to take."""

from typing import Annotated, ClassVar

from lammps_inputs.ingredients.base import Part, Positive
from lammps_inputs.units import Unit


class Limits(Part):
    """Beyond either, `granchain run` refuses; in a scene, or for all scenes in a site's file."""

    example: ClassVar[str] = "{gigabytes: 200, hours: 100}"

    gigabytes: Annotated[Positive, Unit("GB", always=True)] | None = None
    """Size of all frames; 20 if omitted."""
    hours: Annotated[Positive, Unit("h", always=True)] | None = None
    """Estimated time of the run; 24 if omitted."""
