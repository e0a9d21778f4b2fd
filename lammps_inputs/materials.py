"""Elastic constants and density of materials by name, each with its source.

A row never changes, as stored scenes may name it; other values of a material get another name.
"""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

Name = Literal["steel", "steel-420c", "steel-52100", "brass", "aluminium", "titanium", "glass", "ptfe"]
CONSTANTS = ("youngs_modulus", "poisson_ratio", "density")


class Solid(NamedTuple):
    """An isotropic elastic solid, in SI units, and the publication of its values (a key of `references.bib`)."""

    youngs_modulus: float
    poisson_ratio: float
    density: float
    source: str
    meaning: str


CATALOGUE: dict[str, Solid] = {
    "steel": Solid(193e9, 0.3, 8000.0, "daraio2006", "Stainless steel AISI 316"),
    "steel-420c": Solid(226e9, 0.3, 7650.0, "coste1997", "Stainless steel AISI 420C, bearing balls"),
    "steel-52100": Solid(203e9, 0.3, 7780.0, "job2005", "Chrome steel AISI 52100 (100Cr6), bearing balls"),
    "brass": Solid(103e9, 0.34, 8500.0, "carretero2009", "Brass, alloy 260"),
    "aluminium": Solid(68.9e9, 0.33, 2700.0, "davis1993", "Aluminium alloy 6061-T6"),
    "titanium": Solid(113.8e9, 0.342, 4430.0, "boyer1994", "Titanium alloy Ti-6Al-4V"),
    "glass": Solid(70e9, 0.2, 2500.0, "en572", "Soda lime silicate glass"),
    "ptfe": Solid(1.46e9, 0.46, 2178.0, "daraio2005", "Polytetrafluoroethylene"),
}


def completed(given: Any, key: str) -> Any:
    """Keys of a bead with the constants of the material that it names; those that are given are kept.

    Args:
        given: what stands in the scene, of any type.
        key: that holds the material's name.

    Raises:
        ValueError: none of the named material's constants would be used.
    """
    name = given.get(key) if isinstance(given, Mapping) else None
    if not isinstance(name, str):
        return given
    solid = CATALOGUE.get(name, CATALOGUE["steel"])._asdict()  # an unknown name is refused where it is read
    own = {constant: given[constant] for constant in CONSTANTS if given.get(constant) is not None}
    if len(own) == len(CONSTANTS) and not any(own[constant] == solid[constant] for constant in own):
        raise ValueError(f"{name} is named, but {', '.join(own)} are all given; leave the name or the constants out")
    wanted = CONSTANTS if given.get("mass") is None else CONSTANTS[:2]
    return {**given, **{constant: solid[constant] for constant in wanted}, **own}
