"""Elastic constants, density and yield strength of materials by name, each with its source.

A row never changes, as stored scenes may name it; other values of a material get another name.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from pydantic import Field, WithJsonSchema

from lammps_inputs import plugins
from lammps_inputs.units import Unit

CONSTANTS = ("youngs_modulus", "poisson_ratio", "density")

OF_THE_CATALOGUE = "catalogue"
"""In place of a yield strength: that of the named material."""

YIELD_SOURCE = "asm2020"
"""Publication of the yield strengths."""

YieldStrength = Annotated[
    float,
    Field(gt=0, le=1e30),
    Unit("Pa"),
    WithJsonSchema({"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"const": OF_THE_CATALOGUE}]}),
]
"""A number, once `completed`."""


class Solid(NamedTuple):
    """An isotropic elastic solid, in SI units.

    Attributes:
        youngs_modulus: in Pa.
        poisson_ratio: dimensionless.
        density: in kg/m^3.
        source: publication of the values, a key of `references.bib`.
        meaning: name of the material in words.
        yield_strength: in Pa, in tension, annealed or of the temper of the meaning; None where it depends on a
            treatment that is not stated.

    Examples:
        >>> tungsten = granchain.Solid(411e9, 0.28, 19300.0, "my-handbook", "Tungsten")
        >>> tungsten.youngs_modulus, tungsten.yield_strength is None  # in Pa
        (411000000000.0, True)
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float
    source: str
    meaning: str
    yield_strength: float | None = None


CATALOGUE: dict[str, Solid] = {
    "steel": Solid(193e9, 0.3, 8000.0, "daraio2006", "Stainless steel AISI 316", 240e6),
    "steel-420c": Solid(226e9, 0.3, 7650.0, "coste1997", "Stainless steel AISI 420C, bearing balls"),
    "steel-52100": Solid(203e9, 0.3, 7780.0, "job2005", "Chrome steel AISI 52100 (100Cr6), bearing balls"),
    "brass": Solid(103e9, 0.34, 8500.0, "carretero2009", "Brass, alloy 260"),
    "aluminium": Solid(68.9e9, 0.33, 2700.0, "davis1993", "Aluminium alloy 6061-T6", 276e6),
    "titanium": Solid(113.8e9, 0.342, 4430.0, "boyer1994", "Titanium alloy Ti-6Al-4V", 880e6),
    "glass": Solid(70e9, 0.2, 2500.0, "en572", "Soda lime silicate glass"),
    "ptfe": Solid(1.46e9, 0.46, 2178.0, "daraio2005", "Polytetrafluoroethylene"),
}
"""Solids by name, those of other distributions included.

Examples:
    >>> steel = granchain.materials["steel"]
    >>> steel.youngs_modulus, steel.density, steel.source  # Pa, kg/m3, key of references.bib
    (193000000000.0, 8000.0, 'daraio2006')
"""

for _solids in plugins.loaded("materials").values():
    CATALOGUE |= _solids

if TYPE_CHECKING:
    Name = str
else:
    Name = Literal[tuple(CATALOGUE)]
    """Name of a material, of ours or of another distribution's."""


def completed(keys: Any, key: str) -> Any:
    """Keys of a bead with the constants of the material that it names, except those that the scene gives.

    Args:
        keys: content of the scene, of any type.
        key: key that holds the material's name.

    Returns:
        The keys, with the constants; what is no mapping as it is.

    Raises:
        ValueError: none of the named material's constants would be used, or it has no yield strength.
    """
    name = keys.get(key) if isinstance(keys, Mapping) else None
    if isinstance(keys, Mapping) and isinstance(keys.get("yield_strength"), str):
        keys = {**keys, "yield_strength": _yield_strength(keys["yield_strength"], name, key)}
    if not isinstance(name, str):
        return keys
    solid = CATALOGUE.get(name, CATALOGUE["steel"])._asdict()  # an unknown name is refused where it is read
    constants = {constant: keys[constant] for constant in CONSTANTS if keys.get(constant) is not None}
    if len(constants) == len(CONSTANTS) and not any(constants[constant] == solid[constant] for constant in constants):
        raise ValueError(
            f"{name} is named, but {', '.join(constants)} are all given; leave the name or the constants out"
        )
    wanted = CONSTANTS if keys.get("mass") is None else CONSTANTS[:2]
    return {**keys, **{constant: solid[constant] for constant in wanted}, **constants}


def _yield_strength(word: str, name: Any, key: str) -> float:
    """Yield strength of the named material (Pa).

    Raises:
        ValueError: another word, no such material, or one without yield strength.
    """
    if word != OF_THE_CATALOGUE:
        raise ValueError(f"yield_strength: should be a number (Pa) or {OF_THE_CATALOGUE}, {word!r} given")
    strength = CATALOGUE.get(name, CATALOGUE["steel"]).yield_strength if isinstance(name, str) else None
    if strength is None:
        materials = ", ".join(other for other, solid in CATALOGUE.items() if solid.yield_strength)
        reason = f"{name!r}" if name is not None else f"no `{key}`"
        raise ValueError(
            f"yield_strength: {OF_THE_CATALOGUE} holds that of {materials}; {reason} given; valid: 0.25e9 (Pa)"
        )
    return strength
