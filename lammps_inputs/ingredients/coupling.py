"""Springs between the beads of one row in neighbouring chains."""

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from lammps_inputs.ingredients.base import Ingredient
from lammps_inputs.laws.linear import Linear
from lammps_inputs.links import Across

if TYPE_CHECKING:
    from lammps_inputs.scene import BaseScene

MOST = 1e12
"""Dimensionless stiffness; beyond it the rows are rigid."""


class Coupling(Ingredient):
    """Linear springs between neighbouring chains (an open row of chains, 1 - 2 - ... - N)."""

    model: Literal["linear"] = "linear"
    stiffness: Annotated[float, Field(ge=0, le=1e30)]
    """The paper's epsilon * alpha (kappa); N/m with a material."""

    def refuse(self, scene: "BaseScene") -> None:
        """Refuse springs that are as good as rigid."""
        kappa = self.stiffness / scene.scale.stiffness
        if kappa > MOST:
            raise ValueError(
                f"coupling.stiffness: {kappa:.3g} in dimensionless units, so stiff that the rows are rigid; "
                "at most 1e12"
            )

    def links(self, scene: "BaseScene") -> tuple[Across, ...]:
        """None for a single chain, or without stiffness."""
        return springs(self.stiffness / scene.scale.stiffness, scene.chains)


def springs(kappa: float, chains: int) -> tuple[Across, ...]:
    """Between each chain and the next; none for a single chain, or without stiffness (dimensionless)."""
    if kappa == 0.0 or chains == 1:
        return ()
    edges = tuple((chain, chain + 1) for chain in range(chains - 1))
    return (Across("coupling", Linear(kappa), edges=edges),)
