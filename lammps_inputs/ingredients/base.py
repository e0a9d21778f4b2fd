"""What an ingredient of a scene is: keys that a user may write, and what becomes of them."""

from typing import TYPE_CHECKING, ClassVar

from pydantic import BaseModel, ConfigDict

from lammps_inputs.facts import Fact
from lammps_inputs.links import Link

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene


class Part(BaseModel):
    """Keys of a scene that belong together: frozen, and none that is not known."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Ingredient(Part):
    """A part of a scene that makes links between beads; what is not overridden, it does not do."""

    takes_away: ClassVar[frozenset[Fact]] = frozenset()
    """What no longer holds where any of its links exist."""

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse what the scene's other parts make impossible.

        Raises:
            ValueError: naming the key, what was found and what to do.
        """

    def links(self, scene: "BaseScene") -> tuple[Link, ...]:
        """The links that it makes, dimensionless; none where its numbers come to nothing."""
        raise NotImplementedError
