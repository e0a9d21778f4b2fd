"""Material of the beads, with which every number of a scene is in SI units."""

from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, model_validator

from lammps_inputs import materials
from lammps_inputs.ingredients.base import Positive, ScenePart
from lammps_inputs.units import PURE, Label, Unit


class Material(ScenePart):
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
