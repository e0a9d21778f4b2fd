"""Material of the beads, with which every number of a scene is in SI units."""

from collections.abc import Callable
from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, model_validator

from lammps_inputs import materials
from lammps_inputs.facts import Fact
from lammps_inputs.ingredients import plastic
from lammps_inputs.ingredients.base import Ingredient, Positive, Setting, Solids
from lammps_inputs.laws import Law, Parameter
from lammps_inputs.units import PURE, Label, Unit


class Material(Ingredient):
    """Elastic spheres in SI units; with it every other number of the scene is in SI."""

    model_config = ConfigDict(
        json_schema_extra={
            "required": ["radius"],
            "anyOf": [{"required": ["name"]}, {"required": [*materials.CONSTANTS]}],
        }
    )

    example: ClassVar[str] = "{name: steel, radius: 4.76e-3}"

    name: materials.Name | None = None
    """Material of the table below, whose constants hold where none are given."""
    radius: Annotated[Positive, Unit("m"), Label("radius of the beads", "R")]
    """Radius R of the beads."""
    density: Annotated[Positive, Unit("kg/m3"), Label("density of the beads", "\\rho")]
    """Mass density of the beads, which are solid spheres; required without `name`."""
    youngs_modulus: Annotated[Positive, Unit("Pa"), Label("Young's modulus", "E")]
    """Young's modulus E; required without `name`."""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5), PURE, Label("Poisson's ratio", "\\nu")]
    """Poisson's ratio; required without `name`."""
    yield_strength: Annotated[materials.YieldStrength | None, Label("yield strength", "\\sigma_y")] = None
    """Yield strength of the beads, whose contacts then yield, or `catalogue`: that of the table below; they are elastic
    if omitted.
    """

    @model_validator(mode="before")
    @classmethod
    def _completed(cls, keys: Any) -> Any:
        return materials.completed(keys, "name")

    def refuse(self, setting: Setting) -> None:
        """Refuse what is not known of beads with a yield strength, whose contacts are those of spheres."""
        contact, key = setting.part("contact"), "material.yield_strength"
        if self.yield_strength is None:
            return
        if contact is not None and not contact.of_spheres:
            raise ValueError(f"contact: other contacts than spheres, which alone yield by {key}; leave one of them out")
        plastic.refuse_at_once(key, self._onset(setting), "; is it in Pa?")
        plastic.refuse(setting, of_spheres=True)

    def lacks(self, setting: Setting) -> frozenset[Fact]:  # noqa: ARG002
        """Facts that no longer hold where the beads have a yield strength."""
        return frozenset() if self.yield_strength is None else frozenset(plastic.WHY)

    def reason(self, key: str, fact: Fact) -> str:
        """Key of the yield strength, and the reason why a fact does not hold."""
        return f"{key}.yield_strength: {plastic.WHY[fact]}"

    def law_between(self, setting: Setting, strength: Parameter, solids: Callable[[], Solids]) -> Law | None:
        """Law of contacts that yield; None of elastic beads."""
        if self.yield_strength is None:
            return None
        return plastic.law_of_spheres(self._onset(setting), strength, solids())

    def _onset(self, setting: Setting) -> float:
        """Overlap at which two of the beads yield, dimensionless."""
        assert self.yield_strength is not None
        constants = self.radius, self.youngs_modulus, self.poisson_ratio, self.yield_strength
        return plastic.overlap_at_yield(*constants) / setting.scale.length
